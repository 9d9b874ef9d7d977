//! Names of blobs.

/// A blob's name: the BLAKE3 hash of its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BlobId(blake3::Hash);

impl BlobId {
    /// The name of a content.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        BlobId(blake3::hash(bytes))
    }
}

impl From<blake3::Hash> for BlobId {
    fn from(hash: blake3::Hash) -> Self {
        BlobId(hash)
    }
}

impl std::fmt::Display for BlobId {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0.to_hex())
    }
}
