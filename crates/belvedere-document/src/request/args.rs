//! Named choices as values of the command line.

use crate::choices;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Command, Error};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use std::ffi::OsStr;
use std::marker::PhantomData;

/// Parser of a plain enum: its names and their help are those of the schema; `-` stands for `_` too.
pub fn one_of<T: JsonSchema + DeserializeOwned + Clone + Send + Sync + 'static>() -> impl TypedValueParser<Value = T> {
    OneOf(PhantomData)
}

#[derive(Debug, Clone)]
struct OneOf<T>(PhantomData<fn() -> T>);

impl<T: JsonSchema> OneOf<T> {
    fn values() -> impl Iterator<Item = PossibleValue> {
        let value =
            |(name, says): (String, String)| PossibleValue::new(name).help(says.trim_end_matches('.').to_owned());
        choices::<T>().into_iter().map(value)
    }
}

impl<T: JsonSchema + DeserializeOwned + Clone + Send + Sync + 'static> TypedValueParser for OneOf<T> {
    type Value = T;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, Error> {
        let text = value.to_string_lossy();
        let known = [text.to_string(), text.replace('-', "_")];
        match known.into_iter().find_map(|name| serde_json::from_value(name.into()).ok()) {
            Some(value) => Ok(value),
            None => {
                let refused = PossibleValuesParser::new(Self::values()).parse_ref(command, arg, value).map(|_| ());
                Err(refused.err().unwrap_or_else(|| Error::new(ErrorKind::InvalidValue).with_cmd(command)))
            }
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(Self::values()))
    }
}
