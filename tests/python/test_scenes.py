"""Scenes and lights that are kept, and what is drawn of them."""
import pickle

import envmap
import numpy as np
import pytest

# The box [-1, 1]^3, seen from inside.
ROOM = ("v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "f 2 4 3 1\nf 7 8 6 5\nf 5 6 2 1\nf 4 8 7 3\nf 3 7 5 1\nf 6 8 4 2\n")
PLACES = [(0, 0, 0), (0.3, -0.2, 0.1), (-0.5, 0, 0)]
RAYS = {'size': 8, 'method': 'raycast', 'ambient': (1, 0.5, 0.25)}


@pytest.fixture
def room(tmp_path):
    (tmp_path / 'room.obj').write_text(ROOM)
    return tmp_path / 'room.obj'


def test_maps_are_those_of_render(room):
    room.write_text(ROOM.removesuffix('f 6 8 4 2\n'))  # Open at +X.
    sky = envmap.generate('sun', size=32, direction=(1, 2, 3), radius=20)
    scene, light = envmap.Scene(room), envmap.Light(sky)
    made = scene.maps(PLACES, environment=light, **RAYS)
    assert len(made) == 3
    for place, one in zip(PLACES, made):
        for alone in (envmap.render(room, at=place, environment=sky, **RAYS), scene.render(at=place, environment=light, **RAYS)):
            np.testing.assert_array_equal(one.array, alone.array)
    assert not np.array_equal(made[0].array, made[1].array)
    picture = scene.view(camera=(0, 0, 0.5), width=16, height=8, environment=light, method='raycast')
    np.testing.assert_array_equal(picture.array, envmap.view(room, camera=(0, 0, 0.5), width=16, height=8, environment=sky, method='raycast').array)


def test_rendered_maps_say_how_they_were_drawn(room):
    made = envmap.render(room, **RAYS)
    assert isinstance(made, envmap.Map) and made.method == 'raycast' and made.missing_solid_angle == 0 and made.remarks == []
    again = pickle.loads(pickle.dumps(made))
    assert isinstance(again, envmap.RenderedMap) and again.method == 'raycast'
    np.testing.assert_array_equal(again.array, made.array)
    with pytest.warns(UserWarning, match='black'):
        dark = envmap.render(room, size=4, method='raycast')
    assert any('black' in remark for remark in dark.remarks)


def test_scenes_come_from_bytes(room, tmp_path):
    scene = envmap.Scene(ROOM.encode())
    np.testing.assert_array_equal(scene.render(**RAYS).array, envmap.render(room, **RAYS).array)
    assert scene.file is None and 'in memory' in repr(scene)
    assert scene.box() == ((-1, -1, -1), (1, 1, 1))
    assert envmap.Scene(str(room)).file == str(room)
    for given in (scene, envmap.Scene(room)):
        again = pickle.loads(pickle.dumps(given))
        assert again.box() == scene.box() and again.nodes == scene.nodes
    light = pickle.loads(pickle.dumps(envmap.Light(envmap.generate('sky', size=16))))
    assert repr(light) == '<envmap.Light of latlong 32x16>'


def test_suns_cast_shadows_as_lights(room):
    """On a floor under a plate, with the sun above: the plate keeps it off, and beside it the floor is as bright as without suns=."""
    floor = 'v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nf 4 3 2 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\nf 8 7 6 5\n'
    sky = envmap.generate('sun', size=256, direction=(0, 1, 0), radius=1, radiance=(1000, 1000, 1000), zenith=(0.01, 0.01, 0.01),
                          ground=(0.01, 0.01, 0.01))
    scene = envmap.Scene(floor.encode())
    view = dict(camera=(0, 3, 0.01), look_at=(0, 0, 0), fov=90, width=32, height=32, method='raycast')
    below = dict(view, camera=(0, 0.5, 0.01), fov=60)
    lights = pickle.loads(pickle.dumps(envmap.Light(sky, suns=True)))
    lit, dark = (scene.view(environment=lights, **how).array for how in (view, below))
    assert lit[16, 2].min() > 20 * dark[16, 16].max()
    texels = scene.view(environment=envmap.Light(sky), **view).array
    assert np.abs(texels[16, 2] / lit[16, 2] - 1).max() < 0.1


def test_grids_are_even_in_even_light(room):
    """Inside of an even box, rays meet it wherever they go."""
    scene = envmap.Scene(room)
    grid = scene.irradiance_grid((2, 3, 4), ambient=(1, 1, 1), error_places=4)
    assert grid.coefficients.shape == (4, 3, 2, 9, 3) and grid.validity.shape == (4, 3, 2)
    assert (grid.validity == 1).all() and grid.low == (-1, -1, -1) and grid.high == (1, 1, 1)
    assert grid.error_places == 4 and grid.rms < 1e-3
    assert np.ptp(grid.coefficients[..., 0, :]) < 1e-3 * grid.coefficients[..., 0, :].max()
    outside = scene.irradiance_grid((1, 1, 1), box=((2, 2, 2), (3, 3, 3)), ambient=(1, 1, 1), error_places=0)
    assert outside.coefficients.shape == (1, 1, 1, 9, 3) and outside.error_places == 0


@pytest.mark.parametrize('call, words', [
    (lambda scene: envmap.Scene('none.glb'), 'none.glb'),
    (lambda scene: envmap.Scene(b'no scene\0'), 'scene in memory'),
    (lambda scene: envmap.Scene('room.obj', folder='.'), 'folder is for a scene in memory'),
    (lambda scene: scene.maps('ball'), 'at must be a list of names and points'),
    (lambda scene: scene.maps(['ball'], method='raycast'), "'ball' is no node"),
    (lambda scene: scene.irradiance_grid((1, 2)), 'cells must be three whole numbers'),
    (lambda scene: scene.irradiance_grid(box=(1, 2, 3)), 'box must be two corners'),
    (lambda scene: scene.irradiance_grid(box=((0, 0, 0), (0, 1, 1))), 'no extent along x'),
    (lambda scene: envmap.Light(np.full((4, 8, 3), np.nan)), 'no radiance'),
    (lambda scene: envmap.render(5), 'scene must be'),
])
def test_errors_say_what_is_wrong(room, call, words):
    with pytest.raises(envmap.Error, match=words) as found:
        call(envmap.Scene(room))
    assert '\n' not in str(found.value)
