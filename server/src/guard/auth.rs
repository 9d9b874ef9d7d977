//! Authentication and authorization: one policy over all routes.
//!
//! Until the first token exists, callers on this machine have all rights, and the service listens on no other address. From then on every
//! request needs a valid token, except for [`OPEN`] routes; expiry or revocation of all tokens does not open the service again.

use std::net::IpAddr;
use std::time::Duration;

use axum::body::Body;
use axum::extract::{MatchedPath, RawPathParams, Request, State};
use axum::http::{HeaderMap, Method, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use drillsweep_api::ProblemKind;
use drillsweep_store::{TokenRecord, TokenScope, TokenSecret, TokensPresent};
use futures::StreamExt as _;
use headers::{Cookie, HeaderMapExt as _};

use crate::answer::error::{Error, Result};
use crate::app::App;
use crate::guard::audit;
use crate::guard::caller::Caller;
use crate::listen::Peer;

/// Routes without a token: health checks, the OpenAPI document, the vocabulary, and the page.
const OPEN: [&str; 8] = [
    "/livez",
    "/readyz",
    "/openapi.json",
    "/v1/quantities",
    "/docs",
    "/",
    "/web/{version}/{*path}",
    // Used to log in; it describes only the session of the caller.
    "/v1/session",
];

/// Name of the session cookie.
pub(crate) const COOKIE: &str = "drillsweep_session";

/// Longest time that an event stream outlives its token.
const LOOK_AGAIN: Duration = Duration::from_secs(5);

/// Admits a request if its caller has the rights, and is within the rate.
pub(crate) async fn guard(
    State(app): State<App>,
    matched: Option<MatchedPath>,
    params: std::result::Result<RawPathParams, axum::extract::rejection::RawPathParamsRejection>,
    mut request: Request,
    next: Next,
) -> Response {
    let route = matched.as_ref().map_or("", MatchedPath::as_str);
    if OPEN.contains(&route) {
        return next.run(request).await;
    }
    let id = params.ok().and_then(|params| {
        let id = params.iter().find(|(name, _)| *name == "id");
        id.map(|(_, value)| value.to_owned())
    });
    let peer = request.extensions().get().copied();
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let headers = request.headers().clone();
    match admit(&app, (&method, &uri, &headers), peer, route, id.as_deref()).await {
        Ok(caller) => {
            request.extensions_mut().insert(caller.clone());
            let response = next.run(request).await;
            audit::note(caller.token(), peer, &method, &uri, &response);
            if is_event_stream(&response) { while_admitted(app, headers, peer, response) } else { response }
        }
        Err(error) => error.into_response(),
    }
}

fn is_event_stream(response: &Response) -> bool {
    response.headers().get(header::CONTENT_TYPE).is_some_and(|kind| kind == "text/event-stream")
}

/// Ends an event stream once its caller has no right to it any more.
fn while_admitted(app: App, headers: HeaderMap, peer: Option<Peer>, response: Response) -> Response {
    let is_refused = async move {
        loop {
            tokio::time::sleep(LOOK_AGAIN).await;
            // An unreachable database does not end the token.
            if identify(&app, &headers, peer).await.is_err_and(|error| error.is_of(ProblemKind::Unauthorized))
            {
                return;
            }
        }
    };
    response.map(|body| Body::from_stream(body.into_data_stream().take_until(Box::pin(is_refused))))
}

async fn admit(
    app: &App,
    (method, uri, headers): (&Method, &Uri, &HeaderMap),
    peer: Option<Peer>,
    route: &str,
    id: Option<&str>,
) -> Result<Caller> {
    let caller = identify(app, headers, peer).await?;
    if let Err(error) = app.limiter.admit(caller.budget()) {
        app.metrics.throttle(caller.budget());
        return Err(error);
    }
    if let Caller::Bearer(token) = &caller {
        tracing::debug!(token.id, token.owner, "admitted");
        permit(app, token, method, uri, route, id).await?;
    }
    Ok(caller)
}

async fn identify(app: &App, headers: &HeaderMap, peer: Option<Peer>) -> Result<Caller> {
    let Some(value) = headers.get(header::AUTHORIZATION) else {
        // Pages of other sites cannot use it: browsers do not send the cookie with their requests (`SameSite`), and `CsrfLayer` refuses
        // their changes.
        if let Some(secret) = session_cookie(headers)
            && let Some(session) = app.store.session(&secret).await?
        {
            note_use(app, &session.token).await;
            return Ok(Caller::Bearer(session.token));
        }
        return match app.store.tokens_present().await? {
            TokensPresent::None => local(headers),
            TokensPresent::OnlyVoid | TokensPresent::Valid => Err(Error::unauthorized(
                "a token is needed: send it as `Authorization: Bearer TOKEN`; `drillsweep token create` makes one",
            )),
        };
    };
    // The scheme is case-insensitive (RFC 9110 section 11.1).
    let secret = value.to_str().ok().and_then(|value| value.split_once(' '));
    let secret = secret.filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"));
    let token = valid_token(app, peer, secret.map_or("", |(_, text)| text)).await?;
    note_use(app, &token).await;
    Ok(Caller::Bearer(token))
}

/// Looks up a token by its text.
///
/// # Errors
/// The token is not valid (401), or too many from its address were not (429).
pub(crate) async fn valid_token(app: &App, peer: Option<Peer>, text: &str) -> Result<TokenRecord> {
    let secret = TokenSecret::parse(text.trim());
    app.invalid_tokens.admit(peer, secret.as_ref())?;
    if let Some(secret) = &secret
        && let Some(token) = app.store.valid_token(secret).await?
    {
        app.invalid_tokens.know(secret);
        return Ok(token);
    }
    app.invalid_tokens.refuse(peer, secret.as_ref());
    Err(Error::unauthorized("the token is unknown, expired or revoked"))
}

/// Text of the session cookie of a request.
pub(crate) fn session_cookie(headers: &HeaderMap) -> Option<TokenSecret> {
    TokenSecret::parse(headers.typed_get::<Cookie>()?.get(COOKIE)?)
}

async fn note_use(app: &App, token: &TokenRecord) {
    if let Err(error) = app.store.touch_token(token).await {
        tracing::warn!(%error, token.id, "the use of a token could not be stored");
    }
}

/// A foreign name that resolves to this machine (DNS rebinding) must not count as local.
fn local(headers: &HeaderMap) -> Result<Caller> {
    let host = headers.get(header::HOST).and_then(|value| value.to_str().ok());
    match host {
        Some(host) if !names_this_machine(host) => Err(Error::new(
            ProblemKind::CrossSite,
            format!("without tokens the service answers to localhost only, not to {host}"),
        )),
        _ => Ok(Caller::Local),
    }
}

fn names_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let address = name.trim_start_matches('[').trim_end_matches(']');
    let name = name.to_ascii_lowercase();
    name == "localhost"
        || name.ends_with(".localhost")
        || address.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

/// Reads need any token; changes need scope submit, and those of other owners' sweeps scope admin.
async fn permit(
    app: &App,
    token: &TokenRecord,
    method: &Method,
    uri: &Uri,
    route: &str,
    id: Option<&str>,
) -> Result<()> {
    if audit::is_reading(method, uri) || token.scope == TokenScope::Admin {
        return Ok(());
    }
    if token.scope < TokenScope::Submit {
        let detail = format!("this token has scope read; {method} needs scope submit or admin");
        return Err(Error::new(ProblemKind::Forbidden, detail));
    }
    if let Some(id) = id.filter(|_| route.starts_with("/v1/sweeps/{id}"))
        && let Some(sweep) = app.store.sweep(id).await?
        && sweep.owner != token.owner
    {
        let detail = format!("the sweep is {}'s; only they or an admin token may change it", sweep.owner);
        return Err(Error::new(ProblemKind::Forbidden, detail));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_this_machine_are_local() {
        for host in
            ["localhost", "LOCALHOST:7340", "127.0.0.1:80", "127.1.2.3", "[::1]:7340", "[::1]", "a.localhost"]
        {
            assert!(names_this_machine(host), "{host}");
        }
        for host in
            ["example.com", "localhost.example.com", "192.168.0.1:7340", "0.0.0.0", "[::2]:1", "", ":80"]
        {
            assert!(!names_this_machine(host), "{host}");
        }
        // Names that anybody can register, which end or begin like local ones.
        for host in
            ["evillocalhost", "evillocalhost:7340", "evil-localhost", "127.0.0.1.evil.com", "127.0.0.1evil"]
        {
            assert!(!names_this_machine(host), "{host}");
        }
    }
}
