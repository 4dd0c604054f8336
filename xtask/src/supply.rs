//! Dependencies: their licences, sources and known vulnerabilities.

use crate::{
    Result,
    process::{cargo, program, root, run},
    setup::Need,
    steps::{Outcome, Steps},
};

/// Reads deny.toml.
const CARGO_DENY: Need = Need::Crate("cargo-deny", "deny --version");
/// Workspaces of Cargo.
const MANIFESTS: [&str; 2] = ["Cargo.toml", "tests/fuzz/Cargo.toml"];
/// Folders with a package-lock.json.
const FOLDERS: [&str; 5] = ["web", "tests/golden", "tests/gltf", "tests/players", "tests/web"];

/// What these checks need.
pub const NEEDS: [Need; 1] = [CARGO_DENY];

/// All checks of dependencies.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "licences and sources", || {
        CARGO_DENY.install()?;
        deny("licenses bans sources")?;
        Ok(Outcome::Passed(format!("{} workspaces", MANIFESTS.len())))
    })?;
    steps.step_with(&NEEDS, "vulnerabilities of crates", || {
        CARGO_DENY.install()?;
        skipped_without_data(deny("advisories"), "failed to fetch advisory database")
    })?;
    steps.step("vulnerabilities of npm packages", || {
        let audit = |folder: &&str| {
            run(program("npm", "audit --package-lock-only --audit-level=low").current_dir(root().join(folder)))
                .map(drop)
        };
        skipped_without_data(FOLDERS.iter().try_for_each(audit), "audit endpoint returned an error")
    })
}

fn deny(checks: &str) -> Result<()> {
    MANIFESTS.iter().try_for_each(|manifest| {
        let config = root().join("deny.toml");
        let mut deny = cargo(&format!("deny --manifest-path {manifest} --config"));
        run(deny.arg(config).args(["check", "--hide-inclusion-graph"]).args(checks.split_whitespace())).map(drop)
    })
}

/// Skips a check whose data cannot be fetched. `sign` is what the program then says.
fn skipped_without_data(result: Result<()>, sign: &str) -> Result<Outcome> {
    match result {
        Ok(()) => Ok(Outcome::Passed(String::new())),
        Err(why) if why.contains(sign) => Ok(Outcome::Skipped(format!("the database cannot be reached: {sign}"))),
        Err(why) => Err(why),
    }
}
