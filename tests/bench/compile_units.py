#!/usr/bin/env python3
"""Measures what the program costs to compile from nothing, in reference units. A unit is the compile of a file that uses CLI11
and nlohmann-json. It is measured in the same run, since machines and their load differ.

  compile_units.py BUILD [WORD...]    BUILD, such as build/ci, must have been built. With WORDs: only units whose output
                                      holds one of them.

Every compile of src/envmap and tools runs alone, without ccache, into a scratch file. Seconds are processor seconds.
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
    """Yields (room, output, command, folder) of each unit of the program, without ccache."""
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
    total = sum(sums.values())
    print(f'{total:7.1f} s  {total / unit:6.1f} units  {len(units)} compiles')
    print(f'one unit: {unit:.2f} s ({min(of_reference):.2f} to {max(of_reference):.2f})')


main()
