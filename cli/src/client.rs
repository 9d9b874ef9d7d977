//! Talking to a server.

use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail};
use bytes::Bytes;
use clap::Args;
use drillsweep_api::{LIMITS, PointList, PointRow, ProblemDetails, ProblemKind, Sweep, SweepList};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use reqwest::header::{AUTHORIZATION, CONTENT_TYPE, HeaderMap, RETRY_AFTER};
use reqwest::{Method, RequestBuilder, StatusCode};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tokio::runtime::Runtime;

/// The environment variable with the token; an argument would show in the list of processes.
const TOKEN: &str = "DRILLSWEEP_TOKEN";

/// Address of a service on this machine.
pub(crate) const DEFAULT_SERVER: &str = "http://127.0.0.1:7340";

/// Characters of a sweep's identifier, a UUID.
const IDENTIFIER_LENGTH: usize = 36;

/// The server of a command.
#[derive(Args, Clone)]
pub(crate) struct ServerArguments {
    /// Address of the server, as a URL or `host:port`. Its token, if it needs one, comes from the environment variable DRILLSWEEP_TOKEN.
    #[arg(long, env = "DRILLSWEEP_SERVER", default_value = DEFAULT_SERVER)]
    pub(crate) server: String,
}

/// Time for which a command that watches tolerates a server without answers, as during a restart.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// Pause between two tries.
pub(crate) const RETRY_PAUSE: Duration = Duration::from_secs(1);

/// A client of one server. Its calls block.
pub(crate) struct Client {
    http: reqwest::Client,
    runtime: Runtime,
    server: String,
    token: Option<String>,
}

/// Answer of a server.
pub(crate) struct Answer {
    pub(crate) status: StatusCode,
    headers: HeaderMap,
    pub(crate) body: Bytes,
}

impl Client {
    pub(crate) fn new(arguments: &ServerArguments) -> anyhow::Result<Self> {
        // An error says that there is one already, which will do.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let token = std::env::var(TOKEN).ok().filter(|token| !token.is_empty());
        Ok(Self {
            http: reqwest::Client::builder().build()?,
            runtime: tokio::runtime::Builder::new_current_thread().enable_all().build()?,
            server: address(&arguments.server),
            token,
        })
    }

    /// The server's address as a URL, without a slash at its end.
    pub(crate) fn server(&self) -> &str {
        &self.server
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
        self.send(Method::POST, path, Some(serde_json::to_vec(body)?), headers)?.json()
    }

    /// Changes what JSON names, and reads JSON.
    pub(crate) fn patch<T: DeserializeOwned>(&self, path: &str, body: &impl Serialize) -> anyhow::Result<T> {
        self.send(Method::PATCH, path, Some(serde_json::to_vec(body)?), &[])?.json()
    }

    /// Deletes, and reads JSON.
    pub(crate) fn delete<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        self.send(Method::DELETE, path, None, &[])?.json()
    }

    /// Reads JSON.
    pub(crate) fn get<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        self.request(path)?.json()
    }

    /// Reads JSON, and retries for a while if the server does not answer or is not available.
    pub(crate) fn get_with_retries<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let answer = self.request(path);
            if !is_worth_another_try(answer.as_ref()) || Instant::now() >= deadline {
                return answer?.json();
            }
            let asked = answer.as_ref().ok().and_then(Answer::retry_after);
            std::thread::sleep(asked.unwrap_or(RETRY_PAUSE));
        }
    }

    /// Identifier of the sweep that a text names by its identifier, the beginning of its identifier, or its name.
    pub(crate) fn sweep_id(&self, text: &str) -> anyhow::Result<String> {
        const FEWEST_CHARACTERS: usize = 4;
        let is_identifier = |text: &str| text.chars().all(|c| c.is_ascii_hexdigit() || c == '-');
        if is_identifier(text) && text.len() == IDENTIFIER_LENGTH {
            return Ok(text.to_owned());
        }
        let found = |filter: &str| -> anyhow::Result<Vec<Sweep>> {
            let path = format!("/v1/sweeps?limit={}&{filter}={}", LIMITS.page_size, path_segment(text));
            Ok(self.get::<SweepList>(&path)?.sweeps)
        };
        let by_identifier = match is_identifier(text) && text.len() >= FEWEST_CHARACTERS {
            true => found("id")?,
            false => Vec::new(),
        };
        let candidates = match by_identifier.is_empty() {
            true => {
                let named = found("name")?;
                named.into_iter().filter(|sweep| sweep.name.as_deref() == Some(text)).collect()
            }
            false => by_identifier,
        };
        match candidates.as_slice() {
            [only] => Ok(only.id.clone()),
            [] => bail!(
                "there is no sweep {text:?}: give its identifier, the beginning of its identifier, or its name (`drillsweep list`)"
            ),
            several => {
                let shown = several.iter().take(10);
                let lines: Vec<_> = shown.map(|sweep| format!("{} of {}", sweep.id, sweep.created)).collect();
                bail!(
                    "{} sweeps match {text:?}; give an identifier, such as\n  {}",
                    several.len(),
                    lines.join("\n  ")
                )
            }
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
    pub(crate) fn bytes(&self, path: &str) -> anyhow::Result<Bytes> {
        self.file(path)?.map_err(|problem| anyhow!("{path}: {problem}"))
    }

    /// Reads a file, or the problem that the server answers with in its place. Causes that concern all files are errors: no server, or
    /// no right to read.
    pub(crate) fn file(&self, path: &str) -> anyhow::Result<Result<Bytes, String>> {
        let answer = self.request(path)?;
        if answer.refuses_all() {
            bail!("{path}: {}", answer.problem());
        }
        if !answer.status.is_success() {
            return Ok(Err(answer.problem()));
        }
        Ok(Ok(answer.body))
    }

    fn request(&self, path: &str) -> anyhow::Result<Answer> {
        self.send(Method::GET, path, None, &[])
    }

    fn send(
        &self,
        method: Method,
        path: &str,
        json: Option<Vec<u8>>,
        headers: &[(&str, &str)],
    ) -> anyhow::Result<Answer> {
        let mut request = self.prepare(method, path);
        if let Some(json) = json {
            request = request.header(CONTENT_TYPE, "application/json").body(json);
        }
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        self.block_on(self.answer(request, path))
    }

    /// A request with this client's token.
    pub(crate) fn prepare(&self, method: Method, path: &str) -> RequestBuilder {
        let request = self.http.request(method, format!("{}{path}", self.server));
        match &self.token {
            Some(token) => request.header(AUTHORIZATION, format!("Bearer {token}")),
            None => request,
        }
    }

    /// Sends a request and reads the whole answer.
    pub(crate) async fn answer(&self, request: RequestBuilder, path: &str) -> anyhow::Result<Answer> {
        let answer = async {
            let response = request.send().await?;
            let (status, headers) = (response.status(), response.headers().clone());
            Ok::<_, reqwest::Error>(Answer { status, headers, body: response.bytes().await? })
        };
        // The error names the address too.
        let answer = answer.await.map_err(reqwest::Error::without_url);
        answer.with_context(|| no_answer(&format!("{}{path}", self.server)))
    }

    pub(crate) fn block_on<T>(&self, future: impl Future<Output = T>) -> T {
        self.runtime.block_on(future)
    }
}

impl Answer {
    fn json<T: DeserializeOwned>(&self) -> anyhow::Result<T> {
        if !self.status.is_success() {
            bail!("{}", self.problem());
        }
        Ok(serde_json::from_slice(&self.body)?)
    }

    /// True if it is a problem of this kind.
    pub(crate) fn is_of(&self, kind: ProblemKind) -> bool {
        let problem = serde_json::from_slice::<ProblemDetails>(&self.body);
        self.status.as_u16() == kind.status() && problem.is_ok_and(|problem| problem.type_uri == kind.uri())
    }

    /// True if all other files would be refused for the same reason.
    pub(crate) fn refuses_all(&self) -> bool {
        matches!(self.status.as_u16(), 401 | 403 | 429)
    }

    /// Wait that the server requests, at most a minute.
    pub(crate) fn retry_after(&self) -> Option<Duration> {
        let seconds: u64 = self.headers.get(RETRY_AFTER)?.to_str().ok()?.parse().ok()?;
        Some(Duration::from_secs(seconds.min(60)))
    }

    /// A problem document in lines for people.
    pub(crate) fn problem(&self) -> String {
        match serde_json::from_slice::<ProblemDetails>(&self.body) {
            Ok(problem) => format!("{}: {problem}", self.status),
            Err(_) => format!("the server answered {}", self.status),
        }
    }
}

/// True if the server does not answer, or is unavailable for the time being.
pub(crate) fn is_worth_another_try(answer: Result<&Answer, &anyhow::Error>) -> bool {
    answer.is_ok_and(|answer| matches!(answer.status.as_u16(), 429 | 502..=504)) || answer.is_err()
}

/// An address as a URL without its last slash; `host:port` is one of HTTP.
fn address(text: &str) -> String {
    let text = text.trim().trim_end_matches('/');
    if text.contains("://") { text.to_owned() } else { format!("http://{text}") }
}

fn no_answer(url: &str) -> String {
    format!("no answer from {url}; is the server up?")
}

/// Characters that are encoded in a segment of a path and in the value of a query: all but RFC 3986's unreserved characters.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// A text as a segment of a path, or as the value of a query.
pub(crate) fn path_segment(text: &str) -> String {
    utf8_percent_encode(text, RESERVED).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_a_url_or_host_and_port() {
        for text in ["http://a:7340", "http://a:7340/", "a:7340", " a:7340/ "] {
            assert_eq!(address(text), "http://a:7340");
        }
        assert_eq!(address("https://a/drillsweep/"), "https://a/drillsweep");
    }

    #[test]
    fn identifiers_cannot_leave_their_place_in_a_path() {
        assert_eq!(path_segment("019a-b_c.~"), "019a-b_c.~");
        assert_eq!(path_segment("../x?y#z é"), "..%2Fx%3Fy%23z%20%C3%A9");
    }
}
