//! Health for supervisors: readiness of the server, or a live worker on this machine.

use std::time::Duration;

use anyhow::ensure;
use clap::Args;
use drillsweep_api::Health;
use drillsweep_store::{Role, Store};

use crate::client::{Client, ServerArguments};
use crate::data::DataArguments;
use crate::print;

#[derive(Args)]
pub(crate) struct HealthArguments {
    #[command(flatten)]
    server: ServerArguments,
    #[command(flatten)]
    data: DataArguments,
    /// Check for a worker on this machine instead of the server.
    #[arg(long)]
    worker: bool,
    /// Seconds without a heartbeat after which a worker counts as gone; workers send one every third of their lease.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, requires = "worker")]
    silence_seconds: f64,
}

/// Fails unless the server is ready, or a worker of this machine has sent a heartbeat.
pub(crate) fn health(arguments: &HealthArguments) -> anyhow::Result<()> {
    if !arguments.worker {
        let _: Health = Client::new(&arguments.server)?.get("/readyz")?;
        print("the server is ready");
        return Ok(());
    }
    let silence = Duration::try_from_secs_f64(arguments.silence_seconds)?;
    let config = arguments.data.existing_store(Role::Worker)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let workers = runtime.block_on(async {
        let store = Store::open(&config).await?;
        let workers = store.workers(i64::try_from(silence.as_millis())?).await?;
        store.close().await;
        anyhow::Ok(workers)
    })?;
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let here = workers.iter().filter(|worker| worker.host == host).count();
    ensure!(here > 0, "no worker on {host} has sent a heartbeat for {} s", arguments.silence_seconds);
    print(&format!("{here} workers on {host}"));
    Ok(())
}
