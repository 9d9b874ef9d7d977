-- Browsers that have logged in by a token. A session is valid as long as its token is, and not after it has expired itself.
CREATE TABLE session (
    -- BLAKE3 of what the browser keeps, which has 256 random bits.
    hash     BYTEA NOT NULL PRIMARY KEY,
    token_id TEXT COLLATE "C" NOT NULL REFERENCES token (id) ON DELETE CASCADE,
    created  BIGINT NOT NULL,
    expires  BIGINT NOT NULL
);

CREATE INDEX session_by_token ON session (token_id);
