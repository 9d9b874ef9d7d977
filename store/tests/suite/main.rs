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
                work_that_another_live_sweep_wants_goes_on,
                work_that_is_wanted_again_before_its_worker_stopped_is_done_after_all,
                what_another_sweep_has_computed_is_the_cancelled_ones_too,
                a_sweep_whose_points_all_go_on_for_another_one_is_finished,
                cancelled_work_is_queued_again_when_it_is_asked_for_again,
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
                of_several_submissions_with_one_idempotency_key_one_is_stored,
                no_row_loses_its_blob_while_garbage_is_collected_over_and_over,
            }
            control {
                a_paused_sweep_is_not_handed_out_until_it_goes_on,
                a_pause_does_not_hold_what_another_sweep_wants,
                what_people_decide_about_a_sweep_can_be_changed,
                a_change_is_refused_where_another_one_was_made_meanwhile,
                points_are_added_once_and_go_on_from_the_last,
                requests_are_kept_in_their_order_and_as_many_are_told_as_asked_for,
                what_is_added_to_a_paused_sweep_waits_with_the_rest,
                a_refresh_computes_anew_and_keeps_the_old_result_until_then,
                a_refresh_that_disagrees_is_told,
                a_refresh_by_another_owner_leaves_finished_sweeps_as_they_are,
                a_table_that_a_refresh_lacks_is_told,
                a_refresh_of_what_was_measured_may_disagree,
                a_refresh_goes_by_what_becomes_of_the_sweep_that_wants_it,
                a_refresh_that_fails_leaves_the_old_result_and_says_why,
                a_refresh_begins_at_the_beginning,
                only_what_is_known_is_taken_or_nothing_is_stored,
                sweeps_are_found_by_their_tags_and_states,
            }
            counts {
                counts_and_end_agree_with_the_points_after_every_step_of_a_random_history,
                events_tell_the_history_in_the_order_of_versions,
            }
            failure {
                what_was_given_up_is_listed_over_all_sweeps_the_latest_first,
                an_error_that_is_no_json_has_no_class,
            }
            fairness {
                ten_points_do_not_wait_for_ten_thousand,
                ten_points_do_not_wait_for_the_ten_thousand_that_they_are_among,
                an_owner_cannot_jump_the_queue_with_many_small_sweeps,
                idle_time_is_not_saved_up,
                who_goes_on_by_its_results_takes_turns_as_well,
                urgency_counts_within_an_owner_only,
                retried_points_do_not_go_before_everybody_else,
            }
            large {
                half_a_sweep_is_seen_by_nobody_and_taken_away,
                a_large_submission_lets_others_in_between,
                a_cancellation_holds_from_its_beginning_and_is_brought_to_its_end,
            }
            lease {
                a_silent_worker_loses_its_point_when_the_lease_ends_and_not_before,
                a_claim_finds_a_lease_that_ended_after_the_last_look,
                open_work_of_an_owner_ends_with_its_points,
                a_buried_workers_points_are_free_at_once_and_nobody_elses,
                a_late_writer_changes_nothing,
                who_reserves_the_blobs_of_a_result_keeps_its_lease,
                a_result_brings_its_worker_the_next_point,
                a_result_that_is_refused_brings_no_point,
                a_result_brings_its_worker_what_a_silent_one_left,
                the_same_worker_cannot_write_under_its_earlier_claim,
                a_renewal_extends_the_lease_and_carries_the_progress,
                a_point_whose_workers_die_three_times_is_dead,
                what_is_known_of_the_last_worker_is_told,
                a_point_given_back_is_refunded_its_attempt_but_not_its_fencing_token,
                an_infrastructure_failure_waits_5_10_20_40_seconds_or_half_as_long_again_and_is_given_up_at_the_fifth,
                points_that_failed_together_do_not_come_back_together,
                a_checkpoint_reaches_the_next_attempts_until_the_work_is_done,
                work_that_brings_workers_down_is_given_up_whether_they_survive_it_or_not,
                a_worker_gets_only_work_of_its_own_numbers,
                work_of_numbers_that_nobody_computes_any_more_ends_and_says_so,
                the_urgent_goes_first_then_the_order_asked,
                workers_are_listed_while_they_are_heard_of,
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
                what_fails_to_be_computed_again_is_not_tried_at_every_look,
                a_repair_goes_on_whatever_becomes_of_other_sweeps,
                a_repair_waits_while_its_sweep_is_paused,
                what_nobody_computes_any_more_is_not_queued,
                a_check_repairs_all_that_it_finds,
            }
            garbage {
                a_blob_that_no_row_names_goes_after_its_grace,
                a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour,
                blobs_that_are_reserved_together_all_stay_for_an_hour,
                what_a_killed_upload_left_goes_too_and_strange_files_stay,
                an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned,
                a_sweep_goes_at_its_time_and_leaves_what_others_have,
                a_sweep_is_deleted_on_request_unless_it_is_pinned_or_unfinished,
                no_row_names_a_blob_that_is_gone,
                an_owner_who_was_forgotten_begins_like_one_who_was_idle,
            }
            submit {
                a_sweep_is_read_back_as_it_was_submitted,
                a_result_is_read_back_with_its_artifacts_and_fills_the_table,
                the_same_point_is_computed_once_for_every_sweep_that_has_it,
                a_point_that_a_sweep_has_twice_counts_twice_and_is_computed_once,
                a_point_whose_result_is_part_of_a_fuller_one_is_not_computed,
                a_physical_failure_is_final_until_a_retry_is_asked_for,
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
                a_run_is_shared_with_whoever_asks_for_that_very_point,
                runs_are_cancelled_held_hurried_and_retried_with_their_sweep,
                a_run_that_another_live_sweep_wants_goes_on,
                a_run_is_kept_as_long_as_its_sweep,
                added_points_bring_their_runs,
                where_nothing_is_computed_runs_must_be_known_too,
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
                a_refresh_that_disagrees_is_told,
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
                what_fails_to_be_computed_again_is_not_tried_at_every_look,
                a_repair_goes_on_whatever_becomes_of_other_sweeps,
                a_repair_waits_while_its_sweep_is_paused,
                what_nobody_computes_any_more_is_not_queued,
                a_check_repairs_all_that_it_finds,
            }
            garbage {
                a_blob_that_no_row_names_goes_after_its_grace,
                a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour,
                blobs_that_are_reserved_together_all_stay_for_an_hour,
                an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned,
                a_sweep_goes_at_its_time_and_leaves_what_others_have,
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
