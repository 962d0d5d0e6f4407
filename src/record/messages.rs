//! The messages of one rerun store, with sequential ids instead of ids from the clock.

use rerun::{
    AsComponents, EntityPath, SerializedComponentColumn, StoreId, StoreKind, TimeColumn, TimePoint, Timeline,
    external::{
        re_log_types::{SetStoreInfo, StoreInfo, StoreSource},
        re_tuid::Tuid,
    },
    log::{Chunk, ChunkId, LogMsg, RowId},
    time::TimeInt,
};

use super::{entity::TIMELINE, error::RecordError};

/// Messages in the order of logging.
pub(super) struct Messages {
    store_id: StoreId,
    messages: Vec<LogMsg>,
}

impl Messages {
    /// An empty store, with the message that announces it.
    pub fn new(store_id: StoreId) -> Self {
        let info = StoreInfo::new(store_id.clone(), StoreSource::Other("benchdog".to_owned()));
        let announcement = LogMsg::SetStoreInfo(SetStoreInfo { row_id: id(0), info });
        Self { store_id, messages: vec![announcement] }
    }

    /// The store that the messages belong to.
    pub fn store_id(&self) -> &StoreId {
        &self.store_id
    }

    /// All messages.
    pub fn into_messages(self) -> Vec<LogMsg> {
        self.messages
    }

    /// Logs data without time; in a blueprint, at its only time.
    pub fn log_static(&mut self, entity: &EntityPath, what: &dyn AsComponents) -> Result<(), RecordError> {
        let time = match self.store_id.kind() {
            StoreKind::Recording => TimePoint::default(),
            // The viewer reads blueprints on this timeline.
            StoreKind::Blueprint => TimePoint::default().with(Timeline::new_sequence("blueprint"), TimeInt::ZERO),
        };
        self.log_row(entity, time, what)
    }

    fn log_row(&mut self, entity: &EntityPath, time: TimePoint, what: &dyn AsComponents) -> Result<(), RecordError> {
        let id = self.next_id();
        let chunk = Chunk::builder_with_id(ChunkId::from_tuid(id), entity.clone())
            .with_serialized_batches(RowId::from_tuid(id.next()), time, what.as_serialized_batches())
            .build()
            .map_err(RecordError::encode)?;
        self.push(&chunk)
    }

    /// Logs data at a time, s; without time if it is `None`.
    pub fn log(
        &mut self,
        entity: &EntityPath,
        time_s: Option<f64>,
        what: &dyn AsComponents,
    ) -> Result<(), RecordError> {
        let Some(time_s) = time_s else { return self.log_static(entity, what) };
        let time = TimeInt::new_temporal((time_s * 1e9).round() as i64);
        self.log_row(entity, TimePoint::default().with(Timeline::new_duration(TIMELINE), time), what)
    }

    /// Logs data over time: one row for each time, s.
    pub fn log_columns(
        &mut self,
        entity: &EntityPath,
        times_s: &[f64],
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        let times = TimeColumn::new_duration_secs(TIMELINE, times_s.iter().copied());
        let times = [(*times.timeline().name(), times)].into_iter().collect();
        let columns = columns.into_iter().map(|column| (column.descriptor, column.list_array)).collect();
        let id = ChunkId::from_tuid(self.next_id());
        let chunk = Chunk::from_auto_row_ids(id, entity.clone(), times, columns).map_err(RecordError::encode)?;
        self.push(&chunk)
    }

    /// The id of the next chunk. Its rows count up from it, in the lower half.
    fn next_id(&self) -> Tuid {
        id(self.messages.len() as u64)
    }

    fn push(&mut self, chunk: &Chunk) -> Result<(), RecordError> {
        let message = chunk.to_arrow_msg().map_err(RecordError::encode)?;
        self.messages.push(LogMsg::ArrowMsg(self.store_id.clone(), message));
        Ok(())
    }
}

/// The id of the message with this number; the lower half numbers the rows.
fn id(number: u64) -> Tuid {
    Tuid::from_nanos_and_inc(number, 0)
}
