//! A clip made by a Slurm cluster on this machine. A node is killed in the middle.

use super::clip::{FRAMES, FRAMES_PER_PART, PATIENCE, built, compare, folder, scene, single};
use crate::{
    Result,
    process::{program, root, run},
    setup::Need,
};
use std::{
    fs::{self, File},
    path::PathBuf,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

pub const SLURM: Need = Need::Debian(("slurm-wlm", "/usr/sbin/slurmctld"));

const NODES: u32 = 3;
/// First of the ports that the daemons listen on.
const PORT: u32 = 26_817;

/// Makes the clip and compares it with that of one machine.
pub fn check() -> Result<String> {
    let (scene, single, clip) = (scene(), single(), folder().join("clip"));
    let mut cluster = Cluster::start()?;
    let submitted = run(cluster.script("submit.sh").arg(&scene).arg(&clip).args([
        "0",
        &(FRAMES - 1).to_string(),
        &FRAMES_PER_PART.to_string(),
    ]))?;
    let (array, join) = submitted.trim().split_once(' ').ok_or_else(|| format!("submit.sh: {submitted}"))?;
    let Task { part, node, job } = wait_for("a part that is not finished", || cluster.unfinished(array))?;
    cluster.kill(&node, &job)?;
    let followed = run(cluster.script("follow.sh").env("INTERVAL", "1").arg(&clip).args([array, join]))?;
    let job = run(cluster.command("scontrol", "show job").arg(format!("{array}_{part}")))?;
    if !job.contains("Restarts=1") {
        return Err(format!("part {part}, whose node {node} was killed, was not run again:\n{job}"));
    }
    compare(&single, &clip)?;
    let last = followed.lines().last().unwrap_or_default();
    Ok(format!("{last}; {node} killed, its part {part} run again; bytes of a single machine"))
}

fn wait_for<T>(what: &str, mut look: impl FnMut() -> Result<Option<T>>) -> Result<T> {
    let start = Instant::now();
    loop {
        if let Some(found) = look()? {
            return Ok(found);
        }
        if start.elapsed() > PATIENCE {
            return Err(format!("{what}: not within {} s, see {}", PATIENCE.as_secs(), folder().display()));
        }
        thread::sleep(Duration::from_millis(50));
    }
}

/// A task of the job array: its part, its node and the number of its job.
struct Task {
    part: String,
    node: String,
    job: String,
}

/// Controller and node daemons on this machine, which end with this value.
struct Cluster {
    daemons: Vec<(String, Child)>,
}

impl Cluster {
    fn start() -> Result<Self> {
        let host = fs::read_to_string("/proc/sys/kernel/hostname").map_err(|e| format!("hostname: {e}"))?;
        fs::write(configuration(), text(host.trim())).map_err(|e| format!("{}: {e}", configuration().display()))?;
        let state = folder().join("state");
        fs::create_dir_all(&state).map_err(|e| format!("{}: {e}", state.display()))?;
        let mut cluster = Self { daemons: Vec::new() };
        cluster.spawn("controller", "slurmctld", "-D -c -i")?;
        for node in 1..=NODES {
            cluster.spawn(&format!("node{node}"), "slurmd", &format!("-D -N node{node}"))?;
        }
        let idle = || {
            let states = run(&mut cluster.command("sinfo", "--noheader --Node --format=%T"));
            Ok(states
                .is_ok_and(|states| states.lines().filter(|&state| state == "idle").count() == NODES as usize)
                .then_some(()))
        };
        wait_for("Slurm's nodes", idle)?;
        Ok(cluster)
    }

    fn spawn(&mut self, name: &str, daemon: &str, arguments: &str) -> Result<()> {
        let log = folder().join(format!("{name}.txt"));
        let log = File::create(&log).map_err(|e| format!("{}: {e}", log.display()))?;
        let mut command = self.command(daemon, arguments);
        let copy = log.try_clone().map_err(|e| format!("{daemon}: {e}"))?;
        let spawned = command.stdin(Stdio::null()).stdout(log).stderr(copy).spawn();
        self.daemons.push((name.to_owned(), spawned.map_err(|e| format!("{daemon}: {e}"))?));
        Ok(())
    }

    /// A command of Slurm.
    fn command(&self, name: &str, arguments: &str) -> Command {
        let mut command = program(name, arguments);
        command.env("SLURM_CONF", configuration());
        command
    }

    fn script(&self, name: &str) -> Command {
        let mut command = self.command("bash", "");
        command.arg(root().join("examples/farm/slurm").join(name)).env("PCMVS", built("pcmvs"));
        command
    }

    /// A running task of whose frames some are finished but not all.
    fn unfinished(&self, array: &str) -> Result<Option<Task>> {
        let running = "--noheader --array --states=RUNNING --format=%K,%N,%A --jobs";
        let running = run(self.command("squeue", running).arg(array))?;
        let has_begun = |part: &str| {
            let folder = folder().join("clip.parts").join(format!("{part:0>5}"));
            let entries = fs::read_dir(folder).into_iter().flatten().flatten();
            let done = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with("frame_")).count();
            (1..FRAMES_PER_PART as usize - 1).contains(&done)
        };
        let task = |line: &str| {
            let [part, node, job] = line.trim().split(',').collect::<Vec<_>>().try_into().ok()?;
            has_begun(part).then(|| Task { part: part.to_owned(), node: node.to_owned(), job: job.to_owned() })
        };
        Ok(running.lines().find_map(task))
    }

    /// Kills a node as a power failure does: its daemon and all processes of its job.
    fn kill(&mut self, node: &str, job: &str) -> Result<()> {
        let daemon = self.daemons.iter_mut().find(|(name, _)| name == node);
        let (_, daemon) = daemon.ok_or_else(|| format!("there is no {node}"))?;
        daemon.kill().map_err(|e| format!("{node}: {e}"))?;
        // The job's processes have the session of the helper that the daemon has started for it.
        let name = format!("slurmstepd: [{job}.");
        let helper = processes().into_iter().find(|(_, line)| line.starts_with(&name));
        let (helper, _) = helper.ok_or_else(|| format!("the helper of job {job} is not there"))?;
        let session = run(program("ps", "-o sid= -p").arg(helper))?;
        run(program("pkill", "-9 -s").arg(session.trim())).map(drop)
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        // What has ended already is no error.
        for (_, daemon) in &mut self.daemons {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
        for (process, _) in processes() {
            let _ = run(program("kill", "-9").arg(process));
        }
    }
}

/// The processes of the cluster, with their command lines: those that were started with its configuration.
fn processes() -> Vec<(String, String)> {
    let variable = format!("SLURM_CONF={}", configuration().display());
    let process = |entry: fs::DirEntry| {
        let environment = fs::read(entry.path().join("environ")).ok()?;
        let is_ours = environment.split(|&byte| byte == 0).any(|entry| entry == variable.as_bytes());
        let line = fs::read(entry.path().join("cmdline")).ok().filter(|_| is_ours)?;
        Some((entry.file_name().into_string().ok()?, String::from_utf8_lossy(&line).into_owned()))
    };
    fs::read_dir("/proc").into_iter().flatten().flatten().filter_map(process).collect()
}

fn configuration() -> PathBuf {
    folder().join("slurm.conf")
}

/// A cluster without security, for tests on one machine. Nodes are given up early, and their jobs start again at once.
fn text(host: &str) -> String {
    let (folder, nodes) = (folder(), NODES);
    let folder = folder.display();
    let (first, last) = (PORT + 2, PORT + 1 + NODES);
    let (controller, node) = (PORT, PORT + 1);
    format!(
        "ClusterName=pcmvs
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/none
AuthInfo=cred_expire=5
CredType=cred/none
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=6
InactiveLimit=0
MinJobAge=3600
KillWait=5
JobRequeue=1
NodeName=node[1-{nodes}] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1 RealMemory=500
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"
    )
}
