//! Sessions of browsers, which send a token once and keep a cookie that scripts cannot read.

use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::IntoResponse;
use drillsweep_api::{Login, Session};
use drillsweep_store::{SessionRecord, TokensPresent};

use crate::answer::error::{Error, Result};
use crate::answer::extract;
use crate::answer::json::Json;
use crate::answer::records::timestamp;
use crate::app::App;
use crate::guard::auth::{COOKIE, session_cookie, valid_token};
use crate::listen::Peer;
use crate::openapi::answers::Problems;

/// Rate limit of all logins; no owner has this name.
const LOGINS: &str = "\0logins";

/// The session of a browser
///
/// Needs no token. While no tokens exist, there are no sessions, and none is needed.
#[utoipa::path(
    get,
    path = "/v1/session",
    tag = "service",
    operation_id = "get_session",
    security(()),
    responses((status = 200, description = "The session of the request's cookie", body = Session), Problems)
)]
pub(crate) async fn show(State(app): State<App>, headers: HeaderMap) -> Result<impl IntoResponse> {
    let session = match session_cookie(&headers) {
        Some(secret) => app.store.session(&secret).await?,
        None => None,
    };
    let are_needed = app.store.tokens_present().await? != TokensPresent::None;
    Ok(([(header::CACHE_CONTROL, "no-store")], Json(describe(session, are_needed)?)))
}

/// Log in by a token
///
/// For browsers: the answer sets a cookie that replaces the token, until it expires after 30 days or with the token, or is deleted.
/// Programs send their token with each request instead.
#[utoipa::path(
    post,
    path = "/v1/session",
    tag = "service",
    operation_id = "create_session",
    security(()),
    request_body = Login,
    responses((status = 201, description = "The session", body = Session), Problems)
)]
pub(crate) async fn open(
    State(app): State<App>,
    peer: Option<Extension<Peer>>,
    headers: HeaderMap,
    extract::Json(login): extract::Json<Login>,
) -> Result<impl IntoResponse> {
    app.limiter.admit(LOGINS)?;
    let token = valid_token(&app, peer.map(|Extension(peer)| peer), &login.token).await?;
    let secret = app.store.open_session(&token).await?;
    let Some(session) = app.store.session(&secret).await? else {
        return Err(Error::unauthorized("the token has just expired or was revoked"));
    };
    tracing::info!(token.id, token.owner, "logged in");
    let seconds = (session.expires - app.store.now_ms().await?) / 1_000;
    let cookie = set_cookie(&headers, secret.expose(), seconds);
    Ok((StatusCode::CREATED, cookie, Json(describe(Some(session), true)?)))
}

/// Log out
#[utoipa::path(
    delete,
    path = "/v1/session",
    tag = "service",
    operation_id = "delete_session",
    security(()),
    responses((status = 204, description = "The session is over"), Problems)
)]
pub(crate) async fn close(State(app): State<App>, headers: HeaderMap) -> Result<impl IntoResponse> {
    if let Some(secret) = session_cookie(&headers) {
        app.store.close_session(&secret).await?;
    }
    Ok((StatusCode::NO_CONTENT, set_cookie(&headers, "", 0)))
}

/// Inaccessible to scripts and not sent with requests of other sites; `Secure` if the browser uses https.
fn set_cookie(headers: &HeaderMap, value: &str, seconds: i64) -> [(HeaderName, HeaderValue); 2] {
    let is_https = headers.get("x-forwarded-proto").is_some_and(|protocol| protocol == "https");
    let secure = if is_https { "; Secure" } else { "" };
    let cookie = format!("{COOKIE}={value}; HttpOnly; SameSite=Strict; Path=/; Max-Age={seconds}{secure}");
    // It has visible ASCII characters alone.
    let cookie = HeaderValue::try_from(cookie).unwrap_or_else(|_| HeaderValue::from_static(""));
    [(header::SET_COOKIE, cookie), (header::CACHE_CONTROL, HeaderValue::from_static("no-store"))]
}

fn describe(session: Option<SessionRecord>, tokens_required: bool) -> Result<Session> {
    let Some(SessionRecord { token, expires }) = session else {
        return Ok(Session { tokens_required, owner: None, name: None, scope: None, expires: None });
    };
    Ok(Session {
        tokens_required,
        owner: Some(token.owner),
        name: token.name,
        scope: Some(token.scope.as_str().to_owned()),
        expires: Some(timestamp(expires)?),
    })
}
