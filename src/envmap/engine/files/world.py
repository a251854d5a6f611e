# A world lit by background.exr beside this script.
# Run it in the text editor, or: blender SCENE.blend --python world.py
import os
import bpy


def find(name):
    """Looks beside this script, as a text of Blender or as a file, and beside the .blend file."""
    text = bpy.data.texts.get(os.path.basename(__file__))
    paths = [bpy.path.abspath(text.filepath)] if text and text.filepath else []
    paths += [os.path.abspath(__file__), bpy.data.filepath]
    found = [os.path.join(os.path.dirname(path), name) for path in paths]
    for file in found:
        if os.path.isfile(file):
            return file
    raise FileNotFoundError(name + " is not beside world.py: open world.py from its folder (Text > Open), or save the .blend file there")


world = bpy.data.worlds.new("Probe")
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
nodes.clear()
image = nodes.new("ShaderNodeTexEnvironment")
image.image = bpy.data.images.load(find("background.exr"))
image.projection = "EQUIRECTANGULAR"
shader = nodes.new("ShaderNodeBackground")
output = nodes.new("ShaderNodeOutputWorld")
links.new(image.outputs["Color"], shader.inputs["Color"])
links.new(shader.outputs["Background"], output.inputs["Surface"])
bpy.context.scene.world = world
