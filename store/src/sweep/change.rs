//! Changes of sweeps: cancelling, pausing, changing, deleting, retrying.

use crate::engine::database::Transaction;
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::order::{PLACE_OF_A_POINT, POINTS_AT_ONCE, end_of_order};

impl Store {
    /// Cancels a sweep: its points and verification runs that no other live sweep needs are cancelled, leased ones at their worker's next
    /// renewal. Work that continues for another sweep counts as cancelled for this one, until there is a result. False if there is no such
    /// sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn cancel_sweep(&self, id: &str) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = query(sql::sweep::CANCEL).bind(id).execute(&mut tx).await?;
        if changed == 0 {
            let version: Option<i64> = query(sql::sweep::VERSION).bind(id).first_scalar(&mut tx).await?;
            return Ok(version.is_some());
        }
        query(sql::sweep::STOP_WORK).bind(id).execute(&mut tx).await?;
        // From here on the sweep counts as cancelled, and its work follows by and by.
        let mut is_whole = cancel_next(&mut tx, id).await?;
        tx.commit().await?;
        while !is_whole {
            is_whole = self.go_on_cancelling(id).await?;
        }
        Ok(true)
    }

    async fn go_on_cancelling(&self, id: &str) -> Result<bool> {
        let mut tx = self.write().await?;
        let is_whole = cancel_next(&mut tx, id).await?;
        tx.commit().await?;
        Ok(is_whole)
    }

    /// Completes changes that dead processes have left: cancelled sweeps with work that is not cancelled, and hidden sweeps without
    /// progress for `silence_ms`, whose points were partly stored or deleted. Returns the number of sweeps.
    ///
    /// # Errors
    /// The database fails.
    pub async fn finish_partial_changes(&self, silence_ms: i64) -> Result<u64> {
        let hidden: Vec<String> =
            query(sql::sweep::LEFT_HIDDEN).bind(silence_ms).scalars(&self.database).await?;
        for id in &hidden {
            self.take_away(id).await?;
        }
        let cancelled: Vec<String> = query(sql::sweep::HALF_CANCELLED).scalars(&self.database).await?;
        for id in &cancelled {
            while !self.go_on_cancelling(id).await? {}
        }
        Ok((hidden.len() + cancelled.len()) as u64)
    }

    /// Deletes a hidden sweep in parts, so that other writers wait for one part at most.
    pub(crate) async fn take_away(&self, id: &str) -> Result<()> {
        self.cancel_sweep(id).await?;
        let mut deleted_to = 0;
        loop {
            let mut tx = self.write().await?;
            let is_there = query(sql::sweep::HIDE).bind(id).execute(&mut tx).await? == 1;
            if !is_there {
                return Ok(());
            }
            deleted_to += POINTS_AT_ONCE;
            query(sql::sweep::DELETE_POINTS).bind(id).bind(deleted_to).execute(&mut tx).await?;
            let events =
                query(sql::sweep::DELETE_EVENTS).bind(id).bind(POINTS_AT_ONCE).execute(&mut tx).await?;
            let points: i64 = query(sql::sweep::LAST_POINT).bind(id).scalar(&mut tx).await?;
            if events == 0 && points <= deleted_to {
                query(sql::sweep::DELETE).bind(id).execute(&mut tx).await?;
                return tx.commit().await;
            }
            tx.commit().await?;
        }
    }

    /// Pauses or resumes a sweep: while it is paused its points are not claimed, unless another live sweep needs them; leased points
    /// continue. False if there is no such sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn pause_sweep(&self, id: &str, paused: bool) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = query(sql::sweep::PAUSE).bind(id).bind(paused).execute(&mut tx).await?;
        if changed == 1 {
            hold_back(&mut tx, id).await?;
        }
        tx.commit().await?;
        Ok(changed == 1)
    }

    /// Changes the editable fields of a sweep. Open work takes the highest priority of the live sweeps that have it. If a revision is
    /// expected, a sweep of another revision is not changed.
    ///
    /// # Errors
    /// The database fails.
    pub async fn change_sweep(
        &self,
        id: &str,
        changes: &SweepChanges,
        expected: Option<i64>,
    ) -> Result<ChangeOutcome> {
        let mut tx = self.write().await?;
        let changed = query(sql::sweep::CHANGE)
            .bind(id)
            .bind(changes.name.is_some())
            .bind(changes.name.as_ref().and_then(Option::as_deref))
            .bind(changes.priority)
            .bind(changes.tags_json.as_deref())
            .bind(changes.is_pinned)
            .bind(changes.expires.is_some())
            .bind(changes.expires.flatten())
            .bind(expected)
            .execute(&mut tx)
            .await?;
        if changed == 0 {
            let version: Option<i64> = query(sql::sweep::VERSION).bind(id).first_scalar(&mut tx).await?;
            return Ok(version.map_or(ChangeOutcome::NoSuchSweep, |_| ChangeOutcome::OtherRevision));
        }
        if changes.priority.is_some() {
            query(sql::sweep::CHANGE_PRIORITY_OF_WORK).bind(id).execute(&mut tx).await?;
        }
        tx.commit().await?;
        Ok(ChangeOutcome::Changed)
    }

    /// Deletes a sweep that is finished and not pinned, with its points and events, and reports their numbers; a dry run only reports.
    /// Its results stay as long as other sweeps have them, and the others go with the next
    /// [collection](Self::collect_garbage). If a revision is expected, a sweep of another one stays.
    ///
    /// # Errors
    /// The database fails.
    pub async fn delete_sweep(
        &self,
        id: &str,
        expected: Option<i64>,
        is_dry_run: bool,
    ) -> Result<DeleteOutcome> {
        let (results, bytes): (i64, i64) =
            query(sql::sweep::OWN_RESULTS).bind(id).one(&self.database).await?;
        let mut tx = self.write().await?;
        let sweep: Option<(i64, bool, Option<i64>, i64)> =
            query(sql::sweep::DELETABLE).bind(id).first(&mut tx).await?;
        let Some((revision, is_pinned, finished, points)) = sweep else {
            return Ok(DeleteOutcome::NoSuchSweep);
        };
        if expected.is_some_and(|expected| expected != revision) {
            return Ok(DeleteOutcome::OtherRevision);
        }
        if is_pinned {
            return Ok(DeleteOutcome::Pinned);
        }
        if finished.is_none() {
            return Ok(DeleteOutcome::Unfinished);
        }
        if !is_dry_run {
            query(sql::sweep::HIDE).bind(id).execute(&mut tx).await?;
            query(sql::sweep::FORGET_KEYS).bind(id).execute(&mut tx).await?;
            tx.commit().await?;
            self.take_away(id).await?;
        }
        Ok(DeleteOutcome::Deleted {
            points: points.unsigned_abs(),
            results: results.unsigned_abs(),
            bytes: bytes.unsigned_abs(),
        })
    }

    /// Queues the failed and cancelled points and verification runs of a sweep again, behind the other work of their owner; returns the
    /// number of work items, or `None` if there is no such sweep. The cancellation of a cancelled sweep is withdrawn.
    ///
    /// # Errors
    /// The database fails.
    pub async fn retry_sweep(&self, id: &str) -> Result<Option<u64>> {
        let mut tx = self.write().await?;
        let owner: Option<String> = query(sql::sweep::REVIVE).bind(id).first_scalar(&mut tx).await?;
        let Some(owner) = owner else { return Ok(None) };
        query(sql::sweep::KEEP_RUNNING_WORK).bind(id).execute(&mut tx).await?;
        query(sql::sweep::RECOUNT).bind(id).execute(&mut tx).await?;
        let order = end_of_order(&mut tx, &owner).await?;
        let queued = query(sql::sweep::RETRY_WORK)
            .bind(id)
            .bind(&owner)
            .bind(order.last)
            .bind(PLACE_OF_A_POINT)
            .execute(&mut tx)
            .await?;
        hold_back(&mut tx, id).await?;
        tx.commit().await?;
        Ok(Some(queued))
    }
}

/// Outcome of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChangeOutcome {
    /// It is made.
    Changed,
    /// The sweep has another revision than the expected one; it is not changed.
    OtherRevision,
    /// There is no such sweep.
    NoSuchSweep,
}

/// Outcome of a deletion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeleteOutcome {
    /// It is deleted, or would be.
    Deleted {
        /// Its points.
        points: u64,
        /// Results that no other sweep has.
        results: u64,
        /// Size of their tables.
        bytes: u64,
    },
    /// It is pinned, and stays.
    Pinned,
    /// Some of its points are not final; it stays.
    Unfinished,
    /// The sweep has another revision than the expected one; it is not deleted.
    OtherRevision,
    /// There is no such sweep.
    NoSuchSweep,
}

/// Changes to a sweep; absent fields stay as they are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SweepChanges {
    /// Its name, or none any more.
    pub name: Option<Option<String>>,
    /// Its priority.
    pub priority: Option<i64>,
    /// Its tags, as a JSON array.
    pub tags_json: Option<String>,
    /// True to keep the sweep and its data regardless of age.
    pub is_pinned: Option<bool>,
    /// Time of expiry \[ms since the epoch\]: the first collection after it deletes the sweep, if all its points are final and it is
    /// not pinned; `None` means never.
    pub expires: Option<Option<i64>>,
}

/// Cancels the work of the next points of a cancelled sweep. True once there is no more.
async fn cancel_next(tx: &mut Transaction, id: &str) -> Result<bool> {
    let half: Option<(i64, i64)> = query(sql::sweep::CANCELLED_TO).bind(id).first(&mut *tx).await?;
    let Some((after, points)) = half else { return Ok(true) };
    let last = after + POINTS_AT_ONCE;
    let run = |statement| query(statement).bind(id).bind(after).bind(last);
    run(sql::sweep::CANCEL_WORK).execute(&mut *tx).await?;
    let left = run(sql::sweep::LEAVE_WORK).execute(&mut *tx).await?;
    query(sql::sweep::COUNT_EVENTS).bind(id).bind(left as i64).execute(&mut *tx).await?;
    run(sql::sweep::HOLD_BACK).execute(&mut *tx).await?;
    query(sql::sweep::CANCEL_TO).bind(id).bind(last).execute(&mut *tx).await?;
    Ok(last >= points)
}

/// Holds or releases the queued work of a sweep: work is held while all live sweeps that need it are paused.
async fn hold_back(tx: &mut Transaction, id: &str) -> Result<()> {
    query(sql::sweep::HOLD_BACK).bind(id).bind(0).bind(i64::MAX).execute(&mut *tx).await?;
    Ok(())
}
