-- Who may talk to the service. Only hashes: who reads the database learns no token.
CREATE TABLE token (
    -- The beginning of the hash in hexadecimal digits.
    id        TEXT    NOT NULL PRIMARY KEY,
    -- BLAKE3 of the token's text. A token has 256 random bits, so that a slow hash would gain nothing.
    hash      BLOB    NOT NULL UNIQUE,
    owner     TEXT    NOT NULL,
    name      TEXT,
    scope     TEXT    NOT NULL CHECK (scope IN ('read', 'submit', 'admin')),
    created   INTEGER NOT NULL,
    expires   INTEGER,
    revoked   INTEGER,
    -- To within an hour.
    last_used INTEGER
) STRICT;
