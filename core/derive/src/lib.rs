//! Derives that read a node's definition off its struct, so that nothing is stated twice.
//!
//! * `Params`: each field is a parameter. Its doc comment is its description;
//!   `#[param(default = …, unit = "mm", range = 0.1..=50.0, odd, catalog = "dialect")]` the rest.
//!   A field without `default` must be set by the recipe.
//! * `Choice`: an enum of unit variants that a parameter chooses from, spelled in `snake_case`.
//! * `Inputs`: a struct of `&'a T` (wanted) and `Option<&'a T>` (optional) fields, one a port.
//! * `Outputs`: a struct of owned values, one a port.

mod choice;
mod params;
mod ports;

use proc_macro::TokenStream;
use quote::quote;
use syn::{Attribute, DeriveInput, Expr, ExprLit, Lit, Meta, parse_macro_input};

/// Makes a struct the parameters of a node; see the crate's documentation.
#[proc_macro_derive(Params, attributes(param))]
pub fn derive_params(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input), params::expand)
}

/// Makes an enum of unit variants a choice; see the crate's documentation.
#[proc_macro_derive(Choice)]
pub fn derive_choice(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input), choice::expand)
}

/// Makes a struct of references the input ports of a node; see the crate's documentation.
#[proc_macro_derive(Inputs)]
pub fn derive_inputs(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input), ports::expand_inputs)
}

/// Makes a struct of values the output ports of a node; see the crate's documentation.
#[proc_macro_derive(Outputs)]
pub fn derive_outputs(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input), ports::expand_outputs)
}

type Tokens = proc_macro2::TokenStream;

fn expand(input: DeriveInput, derive: impl Fn(&DeriveInput) -> syn::Result<Tokens>) -> TokenStream {
    let tokens = derive(&input).unwrap_or_else(|fault| {
        let fault = fault.to_compile_error();
        quote!(#fault)
    });
    tokens.into()
}

/// The doc comment as one paragraph of text.
fn docs(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value().trim().to_owned()),
            _ => None,
        },
        _ => None,
    });
    lines.collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// The fields of a struct with named fields; none for a unit struct.
fn named_fields(input: &DeriveInput) -> syn::Result<Vec<&syn::Field>> {
    match &input.data {
        syn::Data::Struct(data) => match &data.fields {
            syn::Fields::Named(fields) => Ok(fields.named.iter().collect()),
            syn::Fields::Unit => Ok(Vec::new()),
            syn::Fields::Unnamed(_) => Err(syn::Error::new_spanned(input, "name the fields")),
        },
        _ => Err(syn::Error::new_spanned(input, "only a struct can be derived so")),
    }
}

/// The doc comment of something a user sees; it is an error for it to be missing.
fn required_docs(attributes: &[Attribute], at: &impl quote::ToTokens) -> syn::Result<String> {
    let text = docs(attributes);
    if text.is_empty() {
        return Err(syn::Error::new_spanned(at, "a user reads this: give it a doc comment"));
    }
    Ok(text)
}
