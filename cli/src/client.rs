//! Talking to a server.

use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Args;
use drillsweep_api::{LIMITS, PointList, PointRow, ProblemDetails};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use serde::de::DeserializeOwned;
use ureq::http::{HeaderMap, Response};
use ureq::{Body, RequestBuilder};

/// The environment variable with the token; an argument would show in the list of processes.
const TOKEN: &str = "DRILLSWEEP_TOKEN";

/// Which server.
#[derive(Args, Clone)]
pub(crate) struct ServerArguments {
    /// Address of the server. Its token, where it needs one, comes from the environment variable DRILLSWEEP_TOKEN.
    #[arg(long, env = "DRILLSWEEP_SERVER", default_value = "http://127.0.0.1:7340")]
    pub(crate) server: String,
}

/// How long a command that watches tolerates a server that does not answer, as during a restart.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long it waits between two tries.
const RETRY_PAUSE: Duration = Duration::from_secs(1);

/// A client of one server.
pub(crate) struct Client {
    agent: ureq::Agent,
    server: String,
    token: Option<String>,
}

impl Client {
    pub(crate) fn new(arguments: &ServerArguments) -> Self {
        let config = ureq::Agent::config_builder().http_status_as_error(false).build();
        let token = std::env::var(TOKEN).ok().filter(|token| !token.is_empty());
        Self { agent: config.into(), server: arguments.server.trim_end_matches('/').to_owned(), token }
    }

    /// Posts JSON and reads JSON.
    pub(crate) fn post<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> anyhow::Result<T> {
        self.post_with(path, body, &[])
    }

    /// The same with headers of its own.
    pub(crate) fn post_with<T: DeserializeOwned>(
        &self,
        path: &str,
        body: &impl Serialize,
        headers: &[(&str, &str)],
    ) -> anyhow::Result<T> {
        let url = format!("{}{path}", self.server);
        let mut request = self.authorized(self.agent.post(&url));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let response = request.send_json(body).with_context(|| no_answer(&url))?;
        json(response)
    }

    /// Changes what JSON names, and reads JSON.
    pub(crate) fn patch<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> anyhow::Result<T> {
        let url = format!("{}{path}", self.server);
        json(self.authorized(self.agent.patch(&url)).send_json(body).with_context(|| no_answer(&url))?)
    }

    /// Reads JSON.
    pub(crate) fn get<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        json(self.request(path)?)
    }

    /// Reads JSON, and tries again for a while where the server does not answer or is not available.
    pub(crate) fn get_with_retries<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let answer = self.request(path);
            let is_worth_another_try = match &answer {
                Ok(response) => matches!(response.status().as_u16(), 429 | 502..=504),
                Err(_) => true,
            };
            if !is_worth_another_try || Instant::now() >= deadline {
                return json(answer?);
            }
            std::thread::sleep(
                answer.as_ref().ok().and_then(|r| retry_after(r.headers())).unwrap_or(RETRY_PAUSE),
            );
        }
    }

    /// All points of a sweep, which are served in pages.
    pub(crate) fn points(&self, sweep: &str) -> anyhow::Result<Vec<PointRow>> {
        let path = format!("/v1/sweeps/{}/points?limit={}", path_segment(sweep), LIMITS.page_size);
        let mut all = Vec::new();
        let mut cursor = String::new();
        loop {
            let page: PointList = self.get(&format!("{path}{cursor}"))?;
            all.extend(page.points);
            match page.next {
                Some(next) => cursor = format!("&cursor={}", path_segment(&next)),
                None => return Ok(all),
            }
        }
    }

    /// Reads a file.
    pub(crate) fn bytes(&self, path: &str) -> anyhow::Result<Vec<u8>> {
        let mut response = self.request(path)?;
        if !response.status().is_success() {
            bail!("{path}: {}", problem(&mut response));
        }
        Ok(response.body_mut().with_config().limit(u64::MAX).read_to_vec()?)
    }

    fn request(&self, path: &str) -> anyhow::Result<Response<Body>> {
        let url = format!("{}{path}", self.server);
        self.authorized(self.agent.get(&url)).call().with_context(|| no_answer(&url))
    }

    fn authorized<B>(&self, request: RequestBuilder<B>) -> RequestBuilder<B> {
        match &self.token {
            Some(token) => request.header("authorization", format!("Bearer {token}")),
            None => request,
        }
    }
}

fn no_answer(url: &str) -> String {
    format!("no answer from {url}; is the server up?")
}

fn json<T: DeserializeOwned>(mut response: Response<Body>) -> anyhow::Result<T> {
    if !response.status().is_success() {
        bail!("{}", problem(&mut response));
    }
    Ok(response.body_mut().with_config().limit(u64::MAX).read_json()?)
}

/// Seconds that the server asks to wait for, at most a minute.
fn retry_after(headers: &HeaderMap) -> Option<Duration> {
    let seconds: u64 = headers.get("retry-after")?.to_str().ok()?.parse().ok()?;
    Some(Duration::from_secs(seconds.min(60)))
}

/// A problem document in lines for people.
fn problem(response: &mut Response<Body>) -> String {
    let status = response.status();
    let Ok(problem) = response.body_mut().read_json::<ProblemDetails>() else {
        return format!("the server answered {status}");
    };
    let mut lines = vec![format!("{status}: {}", problem.title), problem.detail];
    for error in problem.errors {
        let place = error.pointer.or(error.parameter).map_or_else(String::new, |place| format!("{place}: "));
        lines.push(format!("  {place}{}", error.detail));
    }
    lines.join("\n")
}

/// What does not stand for itself in a segment of a path and in the value of a query: all but RFC 3986's unreserved characters.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// A text as a segment of a path, or as the value of a query.
pub(crate) fn path_segment(text: &str) -> String {
    utf8_percent_encode(text, RESERVED).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_cannot_leave_their_place_in_a_path() {
        assert_eq!(path_segment("019a-b_c.~"), "019a-b_c.~");
        assert_eq!(path_segment("../x?y#z é"), "..%2Fx%3Fy%23z%20%C3%A9");
    }
}
