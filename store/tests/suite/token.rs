//! Tokens: known by their hash, valid until they expire or are revoked.

use drillsweep_store::{NewToken, Store, TokenScope, TokenSecret, TokensPresent};

use crate::bench::Engine;

const HOUR_MS: i64 = 3_600_000;

async fn create(store: &Store, scope: TokenScope, lifetime_ms: Option<i64>) -> TokenSecret {
    let secret = TokenSecret::generate().unwrap();
    let token = NewToken { secret: &secret, owner: "anne", name: Some("laptop"), scope, lifetime_ms };
    store.create_token(&token).await.unwrap();
    secret
}

pub(crate) async fn a_token_is_found_by_its_text_and_by_no_other<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    assert_eq!(store.tokens_present().await.unwrap(), TokensPresent::None);
    let secret = create(&store, TokenScope::Submit, None).await;
    let other = TokenSecret::generate().unwrap();
    assert_ne!(secret.expose(), other.expose());
    let token = store.valid_token(&secret).await.unwrap().expect("it is valid");
    assert_eq!((token.owner.as_str(), token.scope), ("anne", TokenScope::Submit));
    assert_eq!(token.id, secret.id());
    assert_eq!(store.valid_token(&other).await.unwrap(), None);
    assert_eq!(store.tokens_present().await.unwrap(), TokensPresent::Valid);
}

pub(crate) async fn the_database_does_not_hold_a_token<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let secret = create(&store, TokenScope::Admin, None).await;
    assert!(!format!("{secret:?}").contains(&secret.expose()[4..12]));
    let digits = secret.expose().strip_prefix("dsw_").expect("the prefix that scanners look for");
    let bytes: Vec<u8> =
        (0..32).map(|k| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).unwrap()).collect();
    assert!(engine.database_holds(secret.id().as_bytes()), "what it does hold is found");
    assert!(!engine.database_holds(digits.as_bytes()));
    assert!(!engine.database_holds(&bytes));
}

pub(crate) async fn a_token_ends_with_its_time_or_when_it_is_revoked_and_the_store_stays_closed<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let (short, long) =
        (create(&store, TokenScope::Read, Some(HOUR_MS)).await, create(&store, TokenScope::Read, None).await);
    let later = engine.after(HOUR_MS + 1_000).await;
    assert!(store.valid_token(&short).await.unwrap().is_some());
    assert!(later.valid_token(&short).await.unwrap().is_none());
    assert!(later.valid_token(&long).await.unwrap().is_some());
    assert!(later.revoke_token(&long.id()).await.unwrap());
    assert!(!later.revoke_token("unknown").await.unwrap());
    assert!(store.valid_token(&long).await.unwrap().is_none());
    assert_eq!(store.tokens_present().await.unwrap(), TokensPresent::Valid);
    assert_eq!(later.tokens_present().await.unwrap(), TokensPresent::OnlyVoid);
    assert_eq!(later.tokens().await.unwrap().len(), 2);
    // Made again from the same text, as from a file at every start, a revoked token stays revoked.
    let again =
        NewToken { secret: &long, owner: "eve", name: None, scope: TokenScope::Admin, lifetime_ms: None };
    store.create_token(&again).await.unwrap();
    assert!(store.valid_token(&long).await.unwrap().is_none());
}

pub(crate) async fn the_last_use_is_noted_within_the_hour<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let secret = create(&store, TokenScope::Read, None).await;
    let mut noted = Vec::new();
    for minutes in [0, 30, 61, 90] {
        let store = engine.after(minutes * 60_000).await;
        let token = store.valid_token(&secret).await.unwrap().unwrap();
        store.touch_token(&token).await.unwrap();
        noted.push(store.tokens().await.unwrap()[0].last_used.unwrap());
    }
    assert_eq!(noted[0], noted[1]);
    assert!(noted[2] >= noted[0] + HOUR_MS);
    assert_eq!(noted[2], noted[3]);
}

#[test]
fn texts_that_cannot_be_tokens_are_refused() {
    for text in
        ["", "short", &" ".repeat(40), &"ä".repeat(40), &"x".repeat(201), "0123456789012345678901234567890\n"]
    {
        assert!(TokenSecret::parse(text).is_none(), "{text:?}");
    }
    assert!(TokenSecret::parse(&"x".repeat(32)).is_some());
}
