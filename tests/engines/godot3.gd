# What Godot 3 shows of a baked folder: the largest difference from it in the sky, on a mirror and on a diffuse ball, towards 18
# directions. Those beside the poles: at the very pole its sky shows the mean of the map, the last mip level.
#   xvfb-run -a godot3 --path FOLDER_WITH_PROJECT.GODOT -s godot3.gd FOLDER/background.exr
extends SceneTree

func panorama(path):
	var image = Image.new()
	if image.load(path) != OK:
		print("cannot load ", path)
		quit(1)
	var texture = ImageTexture.new()
	texture.create_from_image(image, Texture.FLAG_FILTER)
	var sky = PanoramaSky.new()
	sky.panorama = texture
	sky.radiance_size = Sky.RADIANCE_SIZE_256
	return sky

func unit_directions():
	var all = [Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0.05, 1, 0.03).normalized(), Vector3(0.05, -1, 0.03).normalized(), Vector3(0, 0, 1), Vector3(0, 0, -1),
		Vector3(3, 2, 1).normalized(), Vector3(-1, 3, 2).normalized(), Vector3(2, -1, -3).normalized(), Vector3(-2, -3, 1).normalized()]
	for x in [-1, 1]:
		for y in [-0.97, 0.97]:
			for z in [-1.02, 1.02]:
				all.append(Vector3(x, y, z).normalized())
	return all

func _init():
	call_deferred("measure")

func measure():
	var view = Viewport.new()
	view.size = Vector2(21, 21)
	view.hdr = true
	view.keep_3d_linear = true
	view.own_world = true
	view.render_target_update_mode = Viewport.UPDATE_ALWAYS
	get_root().add_child(view)
	var environment = Environment.new()
	environment.background_mode = Environment.BG_SKY
	environment.ambient_light_sky_contribution = 1
	environment.tonemap_mode = Environment.TONE_MAPPER_LINEAR
	var camera = Camera.new()
	camera.fov = 10
	camera.environment = environment
	view.add_child(camera)
	camera.current = true
	var ball = MeshInstance.new()
	ball.mesh = SphereMesh.new()
	ball.mesh.radius = 1
	ball.mesh.height = 2
	ball.mesh.radial_segments = 128
	ball.mesh.rings = 64
	var material = SpatialMaterial.new()
	material.albedo_color = Color(1, 1, 1)
	ball.material_override = material
	view.add_child(ball)
	var found = {"sky": 0.0, "mirror": 0.0, "diffuse": 0.0}
	environment.background_sky = panorama(OS.get_cmdline_args()[OS.get_cmdline_args().size() - 1])
	for d in unit_directions():
		var up = Vector3(0, 0, 1) if abs(d.y) > 0.9 else Vector3(0, 1, 0)
		var colour = Vector3(0.5, 0.5, 0.5) + 0.5 * d
		ball.visible = false
		camera.look_at_from_position(Vector3(0, 0, 0), d, up)
		found["sky"] = max(found["sky"], off(yield(middle(view), "completed"), colour))
		ball.visible = true
		camera.look_at_from_position(10 * d, Vector3(0, 0, 0), up)
		material.metallic = 1
		material.roughness = 0
		found["mirror"] = max(found["mirror"], off(yield(middle(view), "completed"), colour))
		material.metallic = 0
		material.roughness = 1
		material.metallic_specular = 0
		found["diffuse"] = max(found["diffuse"], off(yield(middle(view), "completed"), Vector3(0.5, 0.5, 0.5) + d / 3))
	print(JSON.print({"directions": found}))
	quit()

func middle(view):
	for k in 3:
		yield(self, "idle_frame")
	var image = view.get_texture().get_data()
	image.lock()
	var c = image.get_pixel(10, 10)
	image.unlock()
	return Vector3(c.r, c.g, c.b)

func off(a, b):
	var d = a - b
	return max(abs(d.x), max(abs(d.y), abs(d.z)))
