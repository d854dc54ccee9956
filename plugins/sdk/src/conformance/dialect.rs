//! What every dialect must fulfil.
