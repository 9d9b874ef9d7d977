-- Browsers that have logged in by a token. A session is valid as long as its token is, and not after it has expired itself.
CREATE TABLE session (
    -- BLAKE3 of what the browser keeps, which has 256 random bits.
    hash     BLOB NOT NULL PRIMARY KEY,
    token_id TEXT NOT NULL REFERENCES token (id) ON DELETE CASCADE,
    created  INTEGER NOT NULL,
    expires  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE INDEX session_by_token ON session (token_id);
