//! Encodes messages as an `.rrd` file.

use rerun::{
    external::{
        arrow::datatypes::Schema,
        re_log_encoding::{
            CodecError, Decodable, Encodable, Encoder, MessageHeader, MessageKind, RawRrdManifest, RrdFooter,
            StreamFooter, StreamFooterEntry, ToApplication, ToTransport,
        },
    },
    log::LogMsg,
};

use super::error::RecordError;

/// The encoded index of a file.
type FooterRecord = <RrdFooter as ToTransport>::Output;

/// The file of these messages. Equal messages give equal bytes.
pub(super) fn bytes(messages: impl IntoIterator<Item = LogMsg>) -> Result<Vec<u8>, RecordError> {
    let mut bytes = Encoder::encode(messages.into_iter().map(Ok)).map_err(RecordError::encode)?;
    sort_index(&mut bytes).map_err(RecordError::encode)?;
    Ok(bytes)
}

/// Rewrites the index in the order of names. The encoder lists stores and columns in the order of hash maps, which differs
/// from run to run.
fn sort_index(bytes: &mut Vec<u8>) -> Result<(), CodecError> {
    let StreamFooter { entries, .. } = StreamFooter::from_rrd_bytes(bytes)?;
    let [StreamFooterEntry { rrd_footer_byte_span_from_start_excluding_header: span, .. }] = *entries else {
        return Err(CodecError::FrameDecoding("found a file without exactly one index".to_owned()));
    };
    let mut footer =
        FooterRecord::from_rrd_bytes(&bytes[span.start as usize..span.end() as usize])?.to_application(())?;
    for manifest in footer.manifests.values_mut() {
        let mut fields = manifest.sorbet_schema.fields.to_vec();
        fields.sort_by(|a, b| a.name().cmp(b.name()));
        manifest.sorbet_schema = Schema::new_with_metadata(fields, manifest.sorbet_schema.metadata.clone());
        manifest.sorbet_schema_sha256 = RawRrdManifest::compute_sorbet_schema_sha256(&manifest.sorbet_schema)
            .map_err(CodecError::ArrowSerialization)?;
    }
    let mut record = footer.to_transport(())?;
    record.manifests.sort_by_key(|manifest| format!("{:?}", manifest.store_id));
    let mut index = Vec::new();
    record.to_rrd_bytes(&mut index)?;
    bytes.truncate(span.start as usize - MessageHeader::ENCODED_SIZE_BYTES);
    MessageHeader { kind: MessageKind::End, len: index.len() as u64 }.to_rrd_bytes(bytes)?;
    bytes.extend_from_slice(&index);
    StreamFooter::from_rrd_footer_bytes(span.start, &index).to_rrd_bytes(bytes)?;
    Ok(())
}
