-- Blobs that are being written, or found to be there, for a row to come: they are not deleted before it is there. A row stays until it
-- has run out, for another worker may have reserved the same blob.
CREATE TABLE upload (
    blob    TEXT    NOT NULL PRIMARY KEY,
    expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Blobs that are being deleted: nobody reserves one meanwhile.
CREATE TABLE removal (
    blob    TEXT    NOT NULL PRIMARY KEY,
    expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
