//! Talking to a server.

use anyhow::{Context, bail};
use clap::Args;
use serde_json::Value;

/// The environment variable with the token; an argument would show in the list of processes.
const TOKEN: &str = "DRILLSWEEP_TOKEN";

/// Which server.
#[derive(Args, Clone)]
pub(crate) struct ServerArguments {
    /// Address of the server. Its token, where it needs one, comes from the environment variable DRILLSWEEP_TOKEN.
    #[arg(long, env = "DRILLSWEEP_SERVER", default_value = "http://127.0.0.1:7340")]
    pub(crate) server: String,
}

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
    pub(crate) fn post(&self, path: &str, body: &Value) -> anyhow::Result<Value> {
        let url = format!("{}{path}", self.server);
        let response = self
            .authorized(self.agent.post(&url))
            .send_json(body)
            .with_context(|| format!("no answer from {url}; is the server up?"))?;
        self.json(response)
    }

    /// Reads JSON.
    pub(crate) fn get(&self, path: &str) -> anyhow::Result<Value> {
        let response = self.request(path)?;
        self.json(response)
    }

    /// Reads a file.
    pub(crate) fn bytes(&self, path: &str) -> anyhow::Result<Vec<u8>> {
        let mut response = self.request(path)?;
        if !response.status().is_success() {
            bail!("{path}: {}", problem(&mut response));
        }
        Ok(response.body_mut().with_config().limit(u64::MAX).read_to_vec()?)
    }

    fn request(&self, path: &str) -> anyhow::Result<ureq::http::Response<ureq::Body>> {
        let url = format!("{}{path}", self.server);
        self.authorized(self.agent.get(&url))
            .call()
            .with_context(|| format!("no answer from {url}; is the server up?"))
    }

    fn authorized<B>(&self, request: ureq::RequestBuilder<B>) -> ureq::RequestBuilder<B> {
        match &self.token {
            Some(token) => request.header("authorization", format!("Bearer {token}")),
            None => request,
        }
    }

    fn json(&self, mut response: ureq::http::Response<ureq::Body>) -> anyhow::Result<Value> {
        if !response.status().is_success() {
            bail!("{}", problem(&mut response));
        }
        Ok(response.body_mut().read_json()?)
    }
}

/// A problem document in lines for people.
fn problem(response: &mut ureq::http::Response<ureq::Body>) -> String {
    let status = response.status();
    let Ok(problem) = response.body_mut().read_json::<Value>() else {
        return format!("the server answered {status}");
    };
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut lines = vec![format!("{status}: {}", text(&problem["title"]))];
    if !problem["detail"].is_null() {
        lines.push(text(&problem["detail"]));
    }
    for error in problem["errors"].as_array().into_iter().flatten() {
        lines.push(format!("  {}: {}", text(&error["pointer"]), text(&error["detail"])));
    }
    lines.join("\n")
}
