#!/usr/bin/env python3
"""Reconstructs a clip on an OpenCue farm: the frames of one layer make its parts, and those of a second one join them.

    submit.py SCENE OUT FIRST LAST PART [options of `pcmvs reconstruct`]

makes the frames FIRST to LAST, PART of them per task. SCENE, OUT and this folder are on a file system that all hosts
share. The program is `pcmvs` on the PATH of the hosts, or what --pcmvs names. Needs OpenCue's Python packages
(`pip install opencue-pyoutline packaging`), and CUEBOT_HOSTS as all of OpenCue's programs do.

A task that fails is made again up to three times, and goes on with the frames that are missing. --print writes the job's
description and sends nothing.
"""

import argparse
import os
import shlex
from pathlib import Path

# The first import reads OpenCue's configuration.
import outline
import outline.cuerun
from outline.modules.shell import Shell

SCRIPTS = Path(__file__).resolve().parent.parent


def command(script, environment, arguments):
    """A shell command that runs a script of the farm with variables of its own."""
    variables = [f"{name}={value}" for name, value in environment.items()]
    return shlex.join(["env", *variables, str(SCRIPTS / script), *map(str, arguments)])


def job(options, further):
    """The job: a layer of parts, and one that joins them when all have succeeded."""
    scene, out = options.scene.resolve(), options.out.resolve()
    parts = f"{out}.parts"
    tasks = (options.last - options.first) // options.part + 1
    program = {"PCMVS": options.pcmvs}
    clip = outline.Outline(f"pcmvs-{out.name}", show=options.show, shot=options.shot, user=options.user)
    make = Shell(
        "parts",
        # OpenCue replaces the token by the number of the task.
        command=command(
            "part.sh",
            {**program, "INDEX": "#IFRAME#", "THREADS": options.cores},
            [scene, parts, options.first, options.last, options.part, *further],
        ),
        range=f"0-{tasks - 1}",
        cores=options.cores,
        memory=options.memory,
    )
    join = Shell(
        "join",
        command=command("join.sh", program, [parts, out, options.first, options.last, tasks]),
        range="0-0",
    )
    join.depend_all(make)
    clip.add_layer(make)
    clip.add_layer(join)
    return clip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("part", type=int, help="frames per task")
    parser.add_argument("--pcmvs", default="pcmvs", help="the program on the hosts")
    parser.add_argument("--cores", type=int, default=8, help="cores per task")
    parser.add_argument("--memory", default="8g", help="memory per task")
    parser.add_argument("--show", default="testing", help="OpenCue's show")
    parser.add_argument("--shot", default="pcmvs", help="OpenCue's shot")
    parser.add_argument("--user", default=os.environ.get("USER", "pcmvs"))
    parser.add_argument("--print", action="store_true", help="print the job, send nothing")
    options, further = parser.parse_known_args()
    if options.part < 1 or options.last < options.first:
        parser.error("LAST must not lie before FIRST, and PART must be 1 or more")
    launcher = outline.cuerun.OutlineLauncher(job(options, further), maxretries=3)
    if options.print:
        print(launcher.serialize(use_pycuerun=False))
    else:
        (sent,) = launcher.launch(use_pycuerun=False)
        print(sent.name())


if __name__ == "__main__":
    main()
