//! Addresses that send invalid tokens: rate limit, log and count.

use std::collections::{HashMap, HashSet, VecDeque};
use std::net::{IpAddr, Ipv4Addr};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use drillsweep_api::ProblemKind;
use drillsweep_store::TokenSecret;
use prometheus_client::metrics::counter::Counter;

use crate::answer::error::{Error, Result};
use crate::listen::{Peer, network};

/// Refused tokens of one address: at once, and per second in the long run.
const BURST: f64 = 20.0;
const PER_SECOND: f64 = 0.5;

/// Time between two lines of the log about one address.
const BETWEEN_LINES: Duration = Duration::from_secs(60);

/// Number of addresses that are kept; beyond it those longest silent are dropped.
const MOST_ADDRESSES: usize = 10_000;

/// Number of recently valid tokens, which are looked up even if their address is limited: it may be that of a proxy.
const MOST_KNOWN: usize = 1_000;

/// Refused tokens, by address.
#[derive(Default)]
pub(crate) struct InvalidTokens {
    state: Mutex<State>,
    /// Tokens refused since the start.
    refused: Counter,
}

#[derive(Default)]
struct State {
    addresses: HashMap<IpAddr, Source>,
    known: HashSet<String>,
    in_order: VecDeque<String>,
}

struct Source {
    /// Level of the leaky bucket.
    level: f64,
    at: Instant,
    /// Time of the last line of the log, and refused tokens since then.
    logged: Option<Instant>,
    unlogged: u64,
}

impl InvalidTokens {
    /// Counts refused tokens in `refused`.
    pub(crate) fn new(refused: Counter) -> Self {
        Self { state: Mutex::default(), refused }
    }

    /// Admits the lookup of a token.
    ///
    /// # Errors
    /// Too many tokens of its address were refused, and this one was not valid recently (429).
    pub(crate) fn admit(&self, peer: Option<Peer>, secret: Option<&TokenSecret>) -> Result<()> {
        let state = self.state();
        if secret.is_some_and(|secret| state.known.contains(&secret.id())) {
            return Ok(());
        }
        match state.addresses.get(&address(peer)) {
            Some(stranger) if stranger.level(Instant::now()) > BURST - 1.0 => Err(too_many()),
            _ => Ok(()),
        }
    }

    /// Remembers a valid token.
    pub(crate) fn know(&self, secret: &TokenSecret) {
        let mut state = self.state();
        if !state.known.insert(secret.id()) {
            return;
        }
        state.in_order.push_back(secret.id());
        if state.in_order.len() > MOST_KNOWN
            && let Some(oldest) = state.in_order.pop_front()
        {
            state.known.remove(&oldest);
        }
    }

    /// Counts an invalid token.
    pub(crate) fn refuse(&self, peer: Option<Peer>, secret: Option<&TokenSecret>) {
        self.refused.inc();
        let now = Instant::now();
        let mut state = self.state();
        if let Some(secret) = secret {
            state.known.remove(&secret.id());
        }
        state.make_room();
        let address = address(peer);
        let stranger = state.addresses.entry(address).or_insert(Source {
            level: 0.0,
            at: now,
            logged: None,
            unlogged: 0,
        });
        stranger.level = stranger.level(now) + 1.0;
        stranger.at = now;
        stranger.unlogged += 1;
        if stranger.logged.is_none_or(|logged| now - logged >= BETWEEN_LINES) {
            tracing::warn!(
                %address,
                token.id = secret.map(TokenSecret::id),
                number = stranger.unlogged,
                "a token is unknown, expired or revoked"
            );
            stranger.logged = Some(now);
            stranger.unlogged = 0;
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Drops the half of the addresses that is longest silent if there are too many.
    fn make_room(&mut self) {
        if self.addresses.len() < MOST_ADDRESSES {
            return;
        }
        let mut times: Vec<Instant> = self.addresses.values().map(|stranger| stranger.at).collect();
        let middle = times.len() / 2;
        let (_, median, _) = times.select_nth_unstable(middle);
        let median = *median;
        self.addresses.retain(|_, stranger| stranger.at > median);
    }
}

impl Source {
    fn level(&self, now: Instant) -> f64 {
        (self.level - PER_SECOND * (now - self.at).as_secs_f64()).max(0.0)
    }
}

fn too_many() -> Error {
    let detail = "too many tokens from this address were unknown, expired or revoked";
    Error::temporary(ProblemKind::TooManyRequests, detail, Duration::from_secs_f64(1.0 / PER_SECOND))
}

/// Network of a request; the unspecified address without a connection, as in tests.
fn address(peer: Option<Peer>) -> IpAddr {
    peer.map_or(IpAddr::V4(Ipv4Addr::UNSPECIFIED), |Peer(address)| network(address.ip()))
}

#[cfg(test)]
mod tests {
    use axum::http::{StatusCode, header};
    use axum::response::IntoResponse as _;

    use super::*;

    fn peer(address: [u8; 4]) -> Option<Peer> {
        Some(Peer((address, 4_000).into()))
    }

    fn secret(digit: usize) -> TokenSecret {
        TokenSecret::parse(&format!("{digit:0>40}")).expect("it is long enough")
    }

    #[test]
    fn an_address_is_refused_after_a_burst_but_for_tokens_that_were_valid() {
        let invalid_tokens = InvalidTokens::default();
        let (here, there) = (peer([192, 0, 2, 1]), peer([192, 0, 2, 2]));
        invalid_tokens.know(&secret(1));
        let begun = Instant::now();
        let mut admitted = 0;
        for guess in 100..1_100 {
            if invalid_tokens.admit(here, Some(&secret(guess))).is_ok() {
                admitted += 1;
                invalid_tokens.refuse(here, Some(&secret(guess)));
            }
        }
        // A burst of 20, and one for every 2 s of the loop.
        let leaked = begun.elapsed().as_secs_f64() / 2.0;
        assert!(admitted >= 20 && admitted as f64 <= 20.0 + leaked, "{admitted}");
        assert_eq!(invalid_tokens.refused.get(), admitted);
        assert!(invalid_tokens.admit(here, Some(&secret(1))).is_ok());
        assert!(invalid_tokens.admit(there, Some(&secret(2))).is_ok());
        // A revoked token counts like any invalid one.
        invalid_tokens.refuse(here, Some(&secret(1)));
        let refused = invalid_tokens.admit(here, Some(&secret(1))).expect_err("refused").into_response();
        assert_eq!(refused.status(), StatusCode::TOO_MANY_REQUESTS);
        assert_eq!(refused.headers()[header::RETRY_AFTER], "2", "one leaks in 2 s");
    }

    #[test]
    fn the_level_falls_at_a_constant_rate_to_zero() {
        let at = Instant::now();
        let source = Source { level: 12.0, at, logged: None, unlogged: 0 };
        for (seconds, level) in [(0, 12.0), (1, 11.5), (2, 11.0), (10, 7.0), (24, 0.0), (100, 0.0)] {
            assert_eq!(source.level(at + Duration::from_secs(seconds)), level, "after {seconds} s");
        }
    }

    #[test]
    fn refusals_within_a_minute_of_a_line_of_the_log_are_counted_for_the_next_one() {
        let invalid_tokens = InvalidTokens::default();
        let here = peer([192, 0, 2, 1]);
        (0..3).for_each(|_| invalid_tokens.refuse(here, None));
        let mut state = invalid_tokens.state();
        let source = state.addresses.get_mut(&address(here)).expect("it is kept");
        assert_eq!(source.unlogged, 2);
        source.logged = source.logged.and_then(|logged| logged.checked_sub(Duration::from_secs(60)));
        drop(state);
        invalid_tokens.refuse(here, None);
        assert_eq!(invalid_tokens.state().addresses[&address(here)].unlogged, 0);
    }

    #[test]
    fn the_half_of_the_addresses_that_is_longest_silent_makes_room() {
        let begin = Instant::now();
        let mut state = State::default();
        for number in 0..MOST_ADDRESSES as u32 {
            let at = begin + Duration::from_secs(number.into());
            let source = Source { level: 1.0, at, logged: None, unlogged: 0 };
            state.addresses.insert(IpAddr::V4(number.into()), source);
        }
        state.make_room();
        let kept = state.addresses.len();
        assert!(kept.abs_diff(MOST_ADDRESSES / 2) <= 1, "{kept}");
        let earliest = state.addresses.values().map(|source| source.at).min();
        assert_eq!(earliest, Some(begin + Duration::from_secs((MOST_ADDRESSES - kept) as u64)));
    }

    #[test]
    fn addresses_of_one_moment_make_room() {
        let at = Instant::now();
        let source = || Source { level: 1.0, at, logged: None, unlogged: 0 };
        let addresses = (0..MOST_ADDRESSES as u32).map(|number| (IpAddr::V4(number.into()), source()));
        let mut state = State { addresses: addresses.collect(), ..State::default() };
        state.make_room();
        assert!(state.addresses.len() < MOST_ADDRESSES);
    }

    #[test]
    fn memory_does_not_grow_with_addresses_and_tokens() {
        let invalid_tokens = InvalidTokens::default();
        for number in 0..3 * MOST_ADDRESSES {
            let [_, a, b, c] = (number as u32).to_be_bytes();
            invalid_tokens.refuse(peer([10, a, b, c]), None);
        }
        (0..2 * MOST_KNOWN).for_each(|number| invalid_tokens.know(&secret(number)));
        let state = invalid_tokens.state();
        assert!(state.addresses.len() <= MOST_ADDRESSES);
        assert_eq!((state.known.len(), state.in_order.len()), (MOST_KNOWN, MOST_KNOWN));
    }
}
