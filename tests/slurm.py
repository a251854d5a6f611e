#!/usr/bin/env python3
"""Shards on a real Slurm: a cluster of this machine alone (munged, slurmctld and slurmd, started and stopped here, all that they
keep in a folder of the test's own) runs what 'envmap batch --slurm' writes: seven shards in mixed order, of which one is
killed and queued again, and the merge that waits for them. The bytes are those of the whole run. Then the manual's recipe for a farm.

  slurm.py ENVMAP PAGE           PAGE is man/envmap.7; where Slurm is not installed, or this is not root, one line says so and nothing is done (77)
"""
import hashlib
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ENVMAP, PAGE = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
PROGRAMS = ['munged', 'slurmctld', 'slurmd', 'sbatch', 'scontrol', 'squeue']
COUNT = 7


def skip(why):
    print(f'slurm: {why}: skipped')
    sys.exit(77)


os.environ['PATH'] += ':/usr/sbin:/sbin'
if missing := [p for p in PROGRAMS if not shutil.which(p)]:
    skip(f'{", ".join(missing)} not installed')
if os.geteuid() != 0:
    skip('slurmd needs root')


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


class Cluster:
    """Of one node, this one."""

    def __init__(self, folder):
        self.folder, self.started = folder, []
        for name in ('state', 'spool', 'munge'):
            (folder / name).mkdir(mode=0o700)
        (folder / 'munge/key').write_bytes(os.urandom(128))
        (folder / 'munge/key').chmod(0o400)
        host = socket.gethostname().split('.')[0]
        (folder / 'slurm.conf').write_text(f'''
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,requeue_delay=0
JobRequeue=1
KillWait=1
MinJobAge=300
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} RealMemory=1024 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
''')
        os.environ['SLURM_CONF'] = str(folder / 'slurm.conf')
        self.host = host

    def start(self, *command):
        log = open(self.folder / f'{command[0]}.out', 'wb')
        self.started.append(subprocess.Popen(command, stdout=log, stderr=log, cwd=self.folder))

    def __enter__(self):
        munge = self.folder / 'munge'
        self.start('munged', '-F', '--force', f'--key-file={munge}/key', f'--socket={munge}/socket', f'--pid-file={munge}/pid',
                   f'--log-file={munge}/log', f'--seed-file={munge}/seed')
        wait_for('munged', lambda: (munge / 'socket').exists())
        self.start('slurmctld', '-D', '-c')
        wait_for('slurmctld', lambda: 'UP' in ask('scontrol', 'ping'))
        self.start('slurmd', '-D', '-c', '-N', self.host)
        wait_for('slurmd', lambda: 'State=IDLE' in ask('scontrol', 'show', 'node', self.host))
        return self

    def __exit__(self, *_):
        for process in reversed(self.started):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def ask(*command):
    return subprocess.run(command, capture_output=True, text=True).stdout


def wait_for(what, is_so, seconds=60):
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            raise TimeoutError(what)
        time.sleep(0.05)


def run(*command, **more):
    done = subprocess.run(command, capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f'slurm: {" ".join(command)}: {done.returncode}: {done.stdout}{done.stderr}')
    return done.stdout


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test(folder):
    work = folder / 'work'
    work.mkdir()
    run(ENVMAP, 'generate', 'sun', 'sun.exr', '--to', 'latlong', '--size', '32', '--direction', '1,2,3', '--radius', '5', cwd=work)
    job = 'prefilter sun.exr {} --lobe ggx --roughness 0.3 --size 16 --threads 1'
    run(ENVMAP, *job.format('whole.exr').split(), '--quiet', cwd=work)
    order = [4, 1, 7, 3, 6, 2, 5]
    parts = [f'part-{k}.exr' for k in order]
    lines = [job.format(p) + f' --shard {k}/{COUNT}' for k, p in zip(order, parts)]
    (work / 'jobs.txt').write_text('\n'.join([*lines, f'merge {" ".join(parts)} merged.exr']) + '\n')
    run(ENVMAP, 'batch', 'jobs.txt', '--slurm', 'jobs.sh', '--quiet', cwd=work)
    # The second of the array, shard 1, waits until it has been killed once.
    script = (work / 'jobs.sh').read_text()
    held = script.replace('  2) exec ', '  2) if [ ! -e begun ]; then echo $$ > begun; sleep 600; fi; exec ', 1)
    assert held != script
    (work / 'jobs.sh').write_text(held)
    last = run('sh', 'jobs.sh', cwd=work).strip()
    first = str(int(last.split('_')[0]) - 1)
    wait_for('shard 1', lambda: (work / 'begun').exists())
    run('scontrol', 'requeue', f'{first}_2')
    wait_for('the merge', lambda: (work / 'merged.exr').exists() or 'FAILED' in ask('scontrol', 'show', 'job', first), 120)
    restarts = ask('scontrol', 'show', 'job', f'{first}_2')
    if 'Restarts=1' not in restarts:
        sys.exit(f'slurm: shard 1 was not queued again: {restarts}')
    wait_for('the end', lambda: not ask('squeue', '--noheader').strip())
    if digest(work / 'merged.exr') != digest(work / 'whole.exr'):
        sys.exit('slurm: the shards join to other bytes than the whole run')
    left = sorted(p.name for p in work.iterdir() if p.name.startswith('.') and p.name != '.envmap-batch')
    if left:
        sys.exit(f'slurm: left behind: {left}')


def test_recipe(folder):
    """Word for word, but for the line that runs all here, by Ninja: tests/recipes.py has it."""
    work = folder / 'recipe'
    (work / 'probes').mkdir(parents=True)
    for name in 'ab':
        run(ENVMAP, 'generate', 'sky', f'probes/{name}.hdr', '--size', '16', cwd=work)
    blocks = re.findall(r'^\.nf\n\.RS 4\n(.*?)^\.RE\n\.fi$', PAGE.read_text(), re.M | re.S)
    recipe, = (b.replace('\\', '').replace('envmap batch maps.txt -k\n', '') for b in blocks if 'farm.sh' in b)
    run('sh', '-ec', recipe, cwd=work, env={**os.environ, 'PATH': f'{pathlib.Path(ENVMAP).parent}:{os.environ["PATH"]}'})
    wait_for('the farm', lambda: not ask('squeue', '--noheader').strip(), 120)
    for name in 'ab':
        for made in (f'{name}.ktx2', f'{name}-diffuse.exr', f'{name}/background.exr'):
            if not (work / 'probes' / made).exists():
                sys.exit(f'slurm: the farm of envmap(7) did not make {made}')


folder = pathlib.Path(tempfile.mkdtemp(prefix='envmap-slurm-'))
try:
    with Cluster(folder):
        test(folder)
        test_recipe(folder)
    print('slurm: seven shards, one killed and queued again, join to the bytes of the whole')
except TimeoutError as late:
    logs = '\n'.join(f'{p}: {p.read_text(errors="replace")[-2000:]}' for p in [*folder.glob('*.log'), *folder.glob('*.out')])
    sys.exit(f'slurm: {late}: waited in vain\n{logs}')
finally:
    shutil.rmtree(folder, ignore_errors=True)
