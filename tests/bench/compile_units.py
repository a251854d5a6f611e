#!/usr/bin/env python3
"""What the program costs to compile from nothing, in reference units: a unit is the compile of a file that includes CLI11 and
nlohmann-json and uses both. Machines and their load differ; a unit is measured in the same run.

  compile_units.py BUILD [WORD...]    e.g. build/ci, which must have been built: generated sources and precompiled headers are taken
                                      from there. With WORDs only units whose output holds one of them.

Every compile of src/envmap and tools runs alone, without ccache, into a scratch file; seconds are processor seconds.
"""
import collections
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

REFERENCE = """
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
int main(int argc, char** argv) {
  CLI::App app;
  int size = 0;
  app.add_option("--size", size)->check(CLI::Range(1, 100));
  CLI11_PARSE(app, argc, argv);
  return nlohmann::ordered_json{{"size", size}}.dump(2).empty();
}
"""


def seconds(command, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, shell=True, cwd=folder, stderr=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f'{command}\n{done.stderr}')
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def compiles(build, words):
    """(room, source, command, folder) of each unit of the program, without ccache and without files beside the object."""
    for entry in json.loads((build / 'compile_commands.json').read_text()):
        command = re.sub(r'^\S*ccache\s+', '', entry['command'])
        output = re.search(r' -o (\S+)', command)[1]
        room = re.match(r'(src/envmap|tools)/', output)
        if room and (not words or any(word in output for word in words)):
            yield room[1], output, command, entry['directory']


def main():
    build, words = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    units = list(compiles(build, words))
    sums, largest = collections.Counter(), []
    with tempfile.TemporaryDirectory() as scratch:
        object_file = os.path.join(scratch, 'unit.o')
        reference = pathlib.Path(scratch) / 'reference.cpp'
        reference.write_text(REFERENCE)
        settings = next(command for _, output, command, _ in units if 'pch' not in output)
        flags = ' '.join(re.findall(r' (-O\S+|-std=\S+|-DNDEBUG)', settings))
        compiler = settings.split()[0]
        one = lambda: seconds(f'{compiler} {flags} -o {object_file} -c {reference}', scratch)
        of_reference = [one()]
        for number, (room, output, command, folder) in enumerate(units):
            command = re.sub(r' -M[DP]\b| -M[TF] \S+', '', command)
            took = seconds(command.replace(f' -o {output}', f' -o {object_file}'), folder)
            sums[room] += took
            largest.append((took, output))
            if number % 40 == 39:
                of_reference.append(one())
        of_reference.append(one())
    unit = sum(of_reference) / len(of_reference)
    for took, output in sorted(largest, reverse=True)[:12]:
        print(f'{took:7.2f} s  {output}')
    for room, took in sums.items():
        print(f'{took:7.1f} s  {took / unit:6.1f} units  {room}')
    print(f'{sum(sums.values()):7.1f} s  {sum(sums.values()) / unit:6.1f} units  {len(units)} compiles; one unit: {unit:.2f} s '
          f'({min(of_reference):.2f} to {max(of_reference):.2f})')


main()
