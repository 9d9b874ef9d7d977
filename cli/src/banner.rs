//! Banner of `drillsweep up`: addresses of page and data, and the way to stop.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use drillsweep_sim::PHYSICS_VERSION;

/// Facts about a service that has started.
pub(crate) struct Banner {
    /// Address on which it listens.
    pub(crate) address: SocketAddr,
    /// Locations of the data, each with its name.
    pub(crate) data: Vec<(&'static str, String)>,
    /// Number of worker processes.
    pub(crate) workers: usize,
}

impl fmt::Display for Banner {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let version = env!("CARGO_PKG_VERSION");
        writeln!(formatter, "drillsweep {version}, physics version {PHYSICS_VERSION}")?;
        writeln!(formatter, "  {:<10}http://{}/", "page", reachable(self.address))?;
        for (name, place) in &self.data {
            writeln!(formatter, "  {name:<10}{place}")?;
        }
        writeln!(formatter, "  {:<10}{}", "workers", self.workers)?;
        write!(formatter, "  {:<10}Ctrl-C", "stop")
    }
}

/// The address under which a browser on this machine reaches a listener.
fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banner_names_an_address_that_a_browser_reaches() {
        for (listening, shown) in [
            ("127.0.0.1:7340", "http://127.0.0.1:7340/"),
            ("0.0.0.0:80", "http://127.0.0.1:80/"),
            ("[::]:7340", "http://[::1]:7340/"),
            ("192.0.2.1:7340", "http://192.0.2.1:7340/"),
        ] {
            let banner = Banner { address: listening.parse().unwrap(), data: Vec::new(), workers: 2 };
            assert!(banner.to_string().lines().any(|line| line.ends_with(shown)), "{banner}");
        }
    }
}
