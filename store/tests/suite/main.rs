//! Guarantees of the store: who gets what to do, what is kept, what a late writer cannot do. Time passes by opening the same
//! store with a later clock.
//!
//! The tests know an engine by the trait [`bench::Engine`] alone. `conformance!` runs all of them for one engine, in that
//! engine's module; a test that it does not list is a function that nobody calls, which the lints refuse. Tests of blobs alone
//! know a place for objects by the trait [`place::Place`].

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

macro_rules! conformance {
    ($engine:ident) => {
        conformance! { $engine:
            cancel {
                queued_points_end_at_once_and_running_ones_at_their_next_renewal,
                work_of_another_live_sweep_continues,
                work_resubmitted_before_its_worker_stopped_is_done,
                a_cancelled_sweep_shares_results_of_another_one,
                a_sweep_whose_points_all_go_on_for_another_one_is_finished,
                cancelled_work_is_queued_by_a_new_request,
                a_retry_takes_back_the_cancellation_of_running_work,
                unwanted_work_that_comes_back_is_not_queued,
                a_result_that_comes_in_spite_of_a_cancellation_is_kept,
            }
            check {
                a_whole_store_has_no_problems_and_damage_to_blobs_is_named,
            }
            concurrency {
                four_workers_share_a_thousand_points_without_losing_or_doubling_one,
                writers_of_every_kind_wait_for_each_other_and_never_find_the_database_locked,
                several_may_open_a_new_store_at_once,
                one_of_several_submissions_with_one_idempotency_key_is_stored,
                no_row_loses_its_blob_while_garbage_is_collected_over_and_over,
            }
            control {
                a_paused_sweep_is_not_handed_out_until_it_goes_on,
                a_pause_does_not_hold_work_of_another_sweep,
                editable_fields_of_a_sweep_are_changed,
                a_change_of_a_stale_version_is_refused,
                points_are_added_once_and_go_on_from_the_last,
                requests_are_kept_in_order_and_returned_up_to_a_limit,
                points_added_to_a_paused_sweep_wait,
                a_refresh_computes_anew_and_keeps_the_old_result_until_then,
                a_disagreeing_refresh_is_reported,
                a_refresh_by_another_owner_leaves_finished_sweeps_as_they_are,
                a_table_missing_from_a_refresh_is_reported,
                a_refresh_of_measured_times_may_disagree,
                a_refresh_follows_the_state_of_its_sweep,
                a_failed_refresh_keeps_the_old_result_and_reports_its_error,
                a_refresh_begins_at_the_beginning,
                a_submission_of_known_points_alone_refuses_others,
                sweeps_are_found_by_their_tags_and_states,
            }
            counts {
                counts_and_end_agree_with_the_points_after_every_step_of_a_random_history,
                events_report_the_history_in_the_order_of_versions,
            }
            failure {
                dead_work_is_listed_over_all_sweeps_latest_first,
                an_error_that_is_no_json_has_no_class,
            }
            fairness {
                ten_points_do_not_wait_for_ten_thousand,
                ten_points_do_not_wait_for_the_ten_thousand_that_they_are_among,
                an_owner_cannot_jump_the_queue_with_many_small_sweeps,
                idle_time_is_not_saved_up,
                workers_that_claim_with_results_take_turns_too,
                urgency_counts_within_an_owner_only,
                retried_points_do_not_precede_other_owners,
            }
            large {
                a_partial_sweep_is_invisible_and_removed,
                a_large_submission_lets_others_in_between,
                a_cancellation_holds_from_its_beginning_and_is_brought_to_its_end,
            }
            lease {
                a_silent_worker_loses_its_point_when_the_lease_ends_and_not_before,
                a_claim_finds_a_lease_that_ended_after_the_last_look,
                open_work_of_an_owner_ends_with_its_points,
                a_buried_worker_releases_its_points_alone_at_once,
                a_late_writer_changes_nothing,
                a_reservation_of_blobs_extends_the_lease,
                a_result_brings_its_worker_the_next_point,
                a_result_that_is_refused_brings_no_point,
                a_result_claims_points_of_an_expired_lease,
                the_same_worker_cannot_write_under_its_earlier_claim,
                a_renewal_extends_the_lease_and_carries_the_progress,
                a_point_whose_workers_die_three_times_is_dead,
                the_error_of_a_dead_point_names_its_last_worker,
                a_point_given_back_is_refunded_its_attempt_but_not_its_fencing_token,
                infrastructure_failures_back_off_exponentially_with_jitter_up_to_the_fifth,
                points_that_failed_together_do_not_come_back_together,
                a_checkpoint_reaches_the_next_attempts_until_the_work_is_done,
                poison_work_is_given_up_even_if_workers_survive,
                a_worker_gets_only_work_of_its_own_numbers,
                work_of_an_abandoned_version_ends_with_its_reason,
                the_urgent_goes_first_then_the_order_asked,
                workers_are_listed_while_their_heartbeat_lasts,
                a_clock_that_is_set_back_keeps_no_point_with_a_dead_worker,
                a_clock_that_is_set_back_holds_up_no_retry,
                a_clock_that_is_set_back_makes_no_dead_worker_alive,
            }
            probe {
                a_probe_leaves_nothing_behind,
                a_probe_notices_that_blobs_cannot_be_written,
            }
            repair {
                a_lost_table_is_computed_again_and_is_whole_then,
                a_failed_repair_is_not_repeated_at_every_read,
                a_repair_does_not_depend_on_other_sweeps,
                a_repair_waits_while_its_sweep_is_paused,
                a_repair_of_an_abandoned_version_is_not_queued,
                a_check_repairs_all_that_it_finds,
            }
            garbage {
                a_blob_that_no_row_names_goes_after_its_grace,
                a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour,
                blobs_that_are_reserved_together_all_stay_for_an_hour,
                leftovers_of_a_killed_upload_are_collected_and_foreign_files_kept,
                an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned,
                a_sweep_expires_and_leaves_shared_results,
                a_sweep_is_deleted_on_request_unless_it_is_pinned_or_unfinished,
                no_row_names_a_blob_that_is_gone,
                a_forgotten_owner_starts_like_an_idle_one,
            }
            submit {
                a_sweep_is_read_back_as_it_was_submitted,
                a_result_is_read_back_with_its_artifacts_and_fills_the_table,
                the_same_point_is_computed_once_for_every_sweep_that_has_it,
                a_point_that_a_sweep_has_twice_counts_twice_and_is_computed_once,
                a_point_whose_result_is_part_of_a_fuller_one_is_not_computed,
                a_physical_failure_is_final_until_a_retry,
                the_same_idempotency_key_gives_the_sweep_that_it_made,
                pages_hold_every_row_once_and_in_order,
                everything_is_there_after_reopening,
            }
            token {
                a_token_is_found_by_its_text_and_by_no_other,
                the_database_does_not_hold_a_token,
                a_token_ends_with_its_time_or_when_it_is_revoked_and_the_store_stays_closed,
                the_last_use_is_noted_within_the_hour,
            }
            verification {
                runs_come_after_the_points_and_end_the_sweep,
                a_run_is_shared_with_sweeps_of_the_same_point,
                runs_are_cancelled_held_hurried_and_retried_with_their_sweep,
                a_run_of_another_live_sweep_continues,
                a_run_is_kept_as_long_as_its_sweep,
                added_points_bring_their_runs,
                a_submission_of_known_points_requires_known_runs,
            }
        }
    };
    ($engine:ident: $($module:ident { $($test:ident,)+ })+) => {
        $(mod $module {
            $(#[tokio::test]
            async fn $test() {
                crate::$module::$test::<super::$engine>().await;
            })+
        })+
    };
}

/// Runs those that write, read or delete objects, in one test: each process that has a bucket starts a server for it. A bucket has no
/// unfinished uploads to be found, and nothing stops its users from writing.
macro_rules! with_objects {
    ($engine:ident) => {
        with_objects! { $engine:
            check {
                a_whole_store_has_no_problems_and_damage_to_blobs_is_named,
            }
            concurrency {
                four_workers_share_a_thousand_points_without_losing_or_doubling_one,
                no_row_loses_its_blob_while_garbage_is_collected_over_and_over,
            }
            control {
                a_refresh_computes_anew_and_keeps_the_old_result_until_then,
                a_disagreeing_refresh_is_reported,
                a_refresh_by_another_owner_leaves_finished_sweeps_as_they_are,
            }
            lease {
                a_late_writer_changes_nothing,
                a_checkpoint_reaches_the_next_attempts_until_the_work_is_done,
            }
            probe {
                a_probe_leaves_nothing_behind,
            }
            repair {
                a_lost_table_is_computed_again_and_is_whole_then,
                a_failed_repair_is_not_repeated_at_every_read,
                a_repair_does_not_depend_on_other_sweeps,
                a_repair_waits_while_its_sweep_is_paused,
                a_repair_of_an_abandoned_version_is_not_queued,
                a_check_repairs_all_that_it_finds,
            }
            garbage {
                a_blob_that_no_row_names_goes_after_its_grace,
                a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour,
                blobs_that_are_reserved_together_all_stay_for_an_hour,
                an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned,
                a_sweep_expires_and_leaves_shared_results,
                a_sweep_is_deleted_on_request_unless_it_is_pinned_or_unfinished,
                no_row_names_a_blob_that_is_gone,
            }
            submit {
                a_result_is_read_back_with_its_artifacts_and_fills_the_table,
                everything_is_there_after_reopening,
            }
        }
    };
    ($engine:ident: $($module:ident { $($test:ident,)+ })+) => {
        #[tokio::test]
        async fn all_that_concerns_objects() {
            $($(
                // The last one that is named is the one that fails.
                eprintln!("{}::{}", stringify!($module), stringify!($test));
                crate::$module::$test::<$engine>().await;
            )+)+
        }
    };
}

mod bench;
mod blobs;
mod bucket;
mod cancel;
mod check;
mod concurrency;
mod control;
mod counts;
mod failure;
mod fairness;
mod faults;
mod garbage;
mod large;
mod lease;
mod place;
mod postgres;
mod probe;
mod repair;
#[path = "../servers/mod.rs"]
mod servers;
mod sqlite;
mod state;
mod submit;
mod tls;
mod token;
mod transfer;
mod verification;
