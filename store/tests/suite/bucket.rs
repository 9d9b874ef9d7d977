//! What becomes of objects that lie in a bucket, seen through the store.

use crate::place::Bucket;
use crate::sqlite::Sqlite;

type InBucket = Sqlite<Bucket>;

conformance! { InBucket:
    check {
        a_whole_store_has_no_problems_and_damage_to_blobs_is_named,
    }
    probe {
        a_probe_leaves_nothing_behind,
    }
    repair {
        a_lost_table_is_computed_again_and_is_whole_then,
        a_check_repairs_all_that_it_finds,
    }
    retention {
        a_blob_that_no_row_names_goes_after_its_grace,
                a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour,
        an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned,
        no_row_names_a_blob_that_is_gone,
    }
}
