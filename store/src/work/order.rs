//! Order of an owner's open work.

use crate::engine::database::Transaction;
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;

/// Distance of one point from the next in its owner's order.
pub(crate) const PLACE_OF_A_POINT: i64 = 1_000;

/// Points that are stored, cancelled or deleted under one hold of the write lock: few enough that others do not have to wait long,
/// and enough that the commits do not count.
pub(crate) const POINTS_AT_ONCE: i64 = 500;

/// Order in which an owner's open work was requested.
#[derive(Clone, Copy)]
pub(crate) struct Order {
    /// The first place that is taken; that of the last without any.
    pub(crate) first: i64,
    /// The last place that is taken.
    pub(crate) last: i64,
}

/// End of an owner's order in the queue; an owner that has had no turn gets the first.
pub(crate) async fn end_of_order(tx: &mut Transaction, owner: &str) -> Result<Order> {
    query(sql::order::INSERT_TURN).bind(owner).execute(&mut *tx).await?;
    let (first, last) = query(sql::order::ENDS_OF_ORDER).bind(owner).one(&mut *tx).await?;
    Ok(Order { first, last })
}
