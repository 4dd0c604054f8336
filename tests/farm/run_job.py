"""Runs a job of OpenCue as its hosts do: every task of a layer is a shell command, and a layer waits for those that it
depends on. Its first argument is the job's description. One task fails at first, as on a host that is switched off.
"""

import subprocess
import sys
import xml.etree.ElementTree as Et

job = Et.parse(sys.argv[1]).getroot()
layers = {layer.get("name"): layer for layer in job.iter("layer")}
waits = {(depend.findtext("deplayer"), depend.findtext("onlayer")) for depend in job.iter("depend")}
retries = int(job.findtext("job/maxretries"))
finished, tasks = [], 0
while len(finished) < len(layers):
    free = [n for n in layers if n not in finished and all(on in finished for layer, on in waits if layer == n)]
    assert free, f"layers wait for each other: {waits}"
    layer = layers[free[0]]
    first, last = map(int, layer.findtext("range").split("-"))
    for index in range(first, last + 1):
        line = layer.findtext("cmd").replace("#IFRAME#", str(index))
        if tasks == 1:
            # Ends the task as soon as it has written a frame.
            subprocess.run(["timeout", "--signal=KILL", "1", "bash", "-c", line], check=False)
        for attempt in range(retries + 1):
            if subprocess.run(["bash", "-c", line], stdout=sys.stderr).returncode == 0:
                break
        else:
            sys.exit(f"layer {free[0]}, task {index} failed {retries + 1} times: {line}")
        tasks += 1
    finished.append(free[0])
print(f"{tasks} tasks of {len(layers)} layers")
