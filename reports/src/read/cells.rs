//! The rows of a stored table as typed values: each field is the cell of its column.

use polars::prelude::{AnyValue, DataFrame, PolarsResult};
use serde::de::value::{Error, MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

use crate::error::ReportError;

/// All rows of a table.
pub(super) fn rows<T: DeserializeOwned>(table: &DataFrame) -> Result<Vec<T>, ReportError> {
    let row = |row: usize| {
        let cell = |column: &'_ polars::prelude::Column| column.get(row).map(AnyValue::into_static);
        let values = table.columns().iter().map(cell).collect::<PolarsResult<Vec<_>>>()?;
        let names = table.columns().iter().map(|column| column.name().as_str());
        let cells = names.zip(values).map(|(column, value)| (column, Cell { column, value }));
        T::deserialize(MapDeserializer::new(cells)).map_err(|why| ReportError::Row { row, why })
    };
    (0..table.height()).map(row).collect()
}

struct Cell<'c> {
    column: &'c str,
    value: AnyValue<'static>,
}

impl IntoDeserializer<'_, Error> for Cell<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Cell<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let read: Result<V::Value, Error> = match self.value {
            AnyValue::Null => visitor.visit_unit(),
            AnyValue::Boolean(is) => visitor.visit_bool(is),
            AnyValue::UInt32(n) => visitor.visit_u32(n),
            AnyValue::UInt64(n) => visitor.visit_u64(n),
            AnyValue::Float64(x) => visitor.visit_f64(x),
            AnyValue::List(list) => {
                let numbers = list.f64().map_err(Error::custom)?;
                visitor.visit_seq(SeqDeserializer::new(numbers.into_no_null_iter()))
            }
            text => visitor.visit_str(text.get_str().unwrap_or_default()),
        };
        read.map_err(|why| Error::custom(format!("column `{}`: {why}", self.column)))
    }

    /// A measure may be undefined; a NaN that reached the table means the same as a null.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.value {
            AnyValue::Null => visitor.visit_none(),
            AnyValue::Float64(x) if x.is_nan() => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

#[cfg(test)]
mod tests;
