//! The drillsweep command.

fn main() -> anyhow::Result<()> {
    anyhow::bail!("no command yet")
}
