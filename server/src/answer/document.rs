//! What the OpenAPI document says of the service as a whole, and of answers that many routes give.

use std::collections::BTreeMap;

use axum::http::header;
use drillsweep_api::{
    DeletedSweep, ExportManifest, PROBLEM_MEDIA_TYPE, PointEvent, PointList, ProblemDetails,
    SelectedPointList,
};
use drillsweep_table::Table;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::openapi::{
    ContentBuilder, ObjectBuilder, Ref, RefOr, Response, ResponseBuilder, Schema, Type, schema::AnyOfBuilder,
};
use utoipa::{IntoParams, IntoResponses, Modify, OpenApi, ToSchema};

use crate::answer::format::{Asked, Format, PictureFormat, TableFormat};

/// What the document says about the service as a whole; the routes add themselves.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "drillsweep",
        version = "1",
        description = "Sweeps of a nonlinear drillstring simulation over flow rate, mud density and any other number. \
            SI units throughout; a field in another unit says so in its name.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    components(schemas(
        ProblemDetails, Table, ExportManifest, PointEvent, DeletedSweep, PointList, SelectedPointList
    )),
    modifiers(&TokenSecurity),
    security(("token" = []), ()),
    tags(
        (name = "sweeps", description = "Submit sweeps and single runs, and follow them"),
        (name = "points", description = "The points of a sweep and their results"),
        (name = "scenarios", description = "Preset scenarios"),
        (name = "service", description = "The service itself"),
    )
)]
pub(crate) struct Document;

/// Says what a token is; the alternative without one holds until the first token exists.
struct TokenSecurity;

impl Modify for TokenSecurity {
    fn modify(&self, document: &mut utoipa::openapi::OpenApi) {
        let scheme = HttpBuilder::new()
            .scheme(HttpAuthScheme::Bearer)
            .description(Some(
                "A token of `drillsweep token create`. Its scope is read, submit or admin. Until the first token \
                 exists none is needed, and the service listens on its own machine only.",
            ))
            .build();
        let components = document.components.get_or_insert_default();
        components.add_security_scheme("token", SecurityScheme::Http(scheme));
    }
}

/// What every route may answer instead of a result.
pub(crate) struct Problems;

impl IntoResponses for Problems {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let problem = ContentBuilder::new().schema(Some(reference::<ProblemDetails>())).build();
        let response = ResponseBuilder::new()
            .description("A problem document (RFC 9457); its `type` tells the kinds apart")
            .content(PROBLEM_MEDIA_TYPE, problem);
        [("default".to_owned(), response.build().into())].into()
    }
}

/// The header by which a client asks only for what it has no copy of.
pub(crate) struct Conditional;

impl IntoParams for Conditional {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        let parameter = ParameterBuilder::new()
            .name(header::IF_NONE_MATCH.as_str())
            .parameter_in(ParameterIn::Header)
            .description(Some("The `ETag` of a copy; 304 if it is still right."))
            .schema(Some(ObjectBuilder::new().schema_type(Type::String)));
        vec![parameter.build()]
    }
}

/// A table in the format that was asked for.
pub(crate) struct TableResponse;

/// A table in the format that was asked for, or its picture.
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
    let unchanged = ResponseBuilder::new().description("The copy is right").build();
    [("200".to_owned(), response.build().into()), ("304".to_owned(), unchanged.into())].into()
}

/// A page of points, whole or in the fields that were asked for.
pub(crate) struct PointPageResponse;

impl IntoResponses for PointPageResponse {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let either =
            AnyOfBuilder::new().item(reference::<PointList>()).item(reference::<SelectedPointList>());
        let content = ContentBuilder::new().schema(Some(Schema::AnyOf(either.build()))).build();
        let response = ResponseBuilder::new()
            .description("A page of points; with `fields`, these of each")
            .content(Format::Json.media_type(), content);
        [("200".to_owned(), response.build().into())].into()
    }
}

fn reference<T: ToSchema>() -> Ref {
    Ref::from_schema_name(T::name())
}
