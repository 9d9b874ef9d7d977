//! Headers and answers of many routes in the OpenAPI document.

use std::collections::BTreeMap;

use axum::http::header;
use drillsweep_api::{PROBLEM_MEDIA_TYPE, PointList, ProblemDetails, SelectedPointList};
use drillsweep_table::Table;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::{
    ContentBuilder, ObjectBuilder, Ref, RefOr, Response, ResponseBuilder, Schema, Type, schema::AnyOfBuilder,
};
use utoipa::{IntoParams, IntoResponses, ToSchema};

use crate::answer::format::{Format, PictureFormat, RequestedFormat, TableFormat};

/// Problems of all routes.
pub(crate) struct Problems;

impl IntoResponses for Problems {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let problem = ContentBuilder::new().schema(Some(reference::<ProblemDetails>())).build();
        let response = ResponseBuilder::new()
            .description("A problem document (RFC 9457); its `type` distinguishes the kinds")
            .content(PROBLEM_MEDIA_TYPE, problem);
        [("default".to_owned(), response.build().into())].into()
    }
}

/// Header `If-None-Match`.
pub(crate) struct Conditional;

impl IntoParams for Conditional {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        let parameter = ParameterBuilder::new()
            .name(header::IF_NONE_MATCH.as_str())
            .parameter_in(ParameterIn::Header)
            .description(Some("`ETag` of the copy that the client has; the answer is 304 if it is current."))
            .schema(Some(ObjectBuilder::new().schema_type(Type::String)));
        vec![parameter.build()]
    }
}

/// A table in the requested format.
pub(crate) struct TableResponse;

/// A table in the requested format, or its picture.
pub(crate) struct PictureResponse;

impl IntoResponses for TableResponse {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        table_responses(TableFormat::OFFERED)
    }
}

impl IntoResponses for PictureResponse {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        table_responses(PictureFormat::OFFERED)
    }
}

fn table_responses(formats: &[Format]) -> BTreeMap<String, RefOr<Response>> {
    let mut response = ResponseBuilder::new().description("The table");
    for format in formats {
        let description = match format {
            Format::Json => None,
            Format::Csv => Some("A line of column names, then a line a row; a missing value is empty."),
            Format::Parquet => Some("Apache Parquet; a missing number is NaN, a missing text empty."),
            Format::Npz => Some("An array a column, as `numpy.load` reads it; a missing number is NaN."),
            Format::Svg => Some("A picture, as a drawing."),
            Format::Png => Some("A picture, as pixels."),
        };
        let content = match description {
            None => ContentBuilder::new().schema(Some(reference::<Table>())),
            Some(description) => {
                let text = ObjectBuilder::new().schema_type(Type::String).description(Some(description));
                let schema = Schema::Object(text.content_media_type(format.media_type()).build());
                ContentBuilder::new().schema(Some(schema))
            }
        };
        response = response.content(format.media_type(), content.build());
    }
    let unchanged = ResponseBuilder::new().description("The copy is current").build();
    [("200".to_owned(), response.build().into()), ("304".to_owned(), unchanged.into())].into()
}

/// A page of points, whole or in the requested fields.
pub(crate) struct PointPageResponse;

impl IntoResponses for PointPageResponse {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let either =
            AnyOfBuilder::new().item(reference::<PointList>()).item(reference::<SelectedPointList>());
        let content = ContentBuilder::new().schema(Some(Schema::AnyOf(either.build()))).build();
        let response = ResponseBuilder::new()
            .description("A page of points, with `fields` in these fields")
            .content(Format::Json.media_type(), content);
        [("200".to_owned(), response.build().into())].into()
    }
}

fn reference<T: ToSchema>() -> Ref {
    Ref::from_schema_name(T::name())
}
