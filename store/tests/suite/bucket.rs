//! Objects in a bucket and their fate, seen through the store on either engine.

/// With a SQLite file.
mod sqlite {
    use crate::place::Bucket;
    use crate::sqlite::Sqlite;

    type InBucket = Sqlite<Bucket>;

    with_objects!(InBucket);
}

/// With a PostgreSQL server: what many machines have in common.
mod postgres {
    use crate::place::Bucket;
    use crate::postgres::Postgres;

    type InBucket = Postgres<Bucket>;

    with_objects!(InBucket);
}
