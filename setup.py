"""'pip install .': CMake builds the module with the library inside. Needs what packages.sh installs; $CMAKE_ARGS are more options
for CMake, as for other packages that it builds."""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        build = pathlib.Path(self.build_temp).resolve()
        build.mkdir(parents=True, exist_ok=True)
        options = {'CMAKE_BUILD_TYPE': 'Release', 'ENVMAP_PYTHON': 'ON', 'ENVMAP_TESTS': 'OFF',
                   'ENVMAP_SAMPLES': 'OFF', 'Python_EXECUTABLE': sys.executable}
        subprocess.run(['cmake', '-G', 'Ninja', '-S', HERE, '-B', build, *(f'-D{k}={v}' for k, v in options.items()),
                        *shlex.split(os.environ.get('CMAKE_ARGS', ''))], check=True)
        subprocess.run(['cmake', '--build', build, '--target', 'envmap_python', 'envmap_formats'], check=True)
        target = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(next((build / 'python/envmap').glob('_envmap*.so')), target)
        shutil.copy2(build / 'envmap-formats.so', target.parent)


setup(ext_modules=[Extension('envmap._envmap', [])], cmdclass={'build_ext': CMakeBuild})
