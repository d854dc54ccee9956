//! Derives that read a node's definition off its struct, so that nothing is stated twice.
//!
//! * `Params`: each field is a parameter. Its doc comment is its description;
//!   `#[param(default = …, unit = "mm", range = 0.1..=50.0, odd, catalog = "dialect")]` the rest.
//!   A field without `default` must be set by the recipe. A field with `entry_of = "…"` and nothing
//!   else holds the parameters of the catalog entry that the named field chose. A field with `shared`
//!   and nothing else holds parameters that several nodes have, declared by a `Params` struct of their own.
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

#[cfg(test)]
mod tests {
    use super::*;
    use syn::parse_quote;

    type Derive = fn(&DeriveInput) -> syn::Result<Tokens>;

    /// Compares what is wrong with a definition; nothing is if `expected` is empty.
    #[track_caller]
    fn check(derive: Derive, input: DeriveInput, expected: &str) {
        let fault = derive(&input).err().map(|fault| fault.to_string()).unwrap_or_default();
        assert_eq!(fault, expected);
    }

    const NO_DOCS: &str = "a user reads this: give it a doc comment";

    #[test]
    fn params_need_docs_and_known_attributes() {
        let derive = params::expand;
        check(
            derive,
            parse_quote!(
                #[doc = " D."]
                struct A;
            ),
            "",
        );
        check(
            derive,
            parse_quote!(
                struct A;
            ),
            NO_DOCS,
        );
        check(
            derive,
            parse_quote!(
                #[doc = "  "]
                struct A;
            ),
            NO_DOCS,
        );
        check(
            derive,
            parse_quote!(
                #[doc = "D"]
                struct A {
                    a: f64,
                }
            ),
            NO_DOCS,
        );
        check(
            derive,
            parse_quote!(
                #[doc = "D"]
                struct A(f64);
            ),
            "name the fields",
        );
        check(
            derive,
            parse_quote!(
                #[doc = "D"]
                enum A {}
            ),
            "only a struct can be derived so",
        );
        let field = |attribute: syn::Attribute, expected: &str| {
            let input = parse_quote!(#[doc = "D"] struct A { #[doc = "D"] #attribute a: f64 });
            check(derive, input, expected);
        };
        field(parse_quote!(#[param(default = 1.0, unit = "mm", range = -1.0..=2.0, odd)]), "");
        field(parse_quote!(#[param(range = 0.1..)]), "");
        field(parse_quote!(#[param(range = ..=2)]), "");
        field(parse_quote!(#[other(whatever)]), "");
        field(parse_quote!(#[param(shared)]), "");
        field(parse_quote!(#[param(shared, unit = "mm")]), "shared stands alone");
        field(parse_quote!(#[param(range = 0.0..2.0)]), "write ..=, the last value is allowed");
        let known = "unknown: default, unit, range, odd, catalog, entry_of or shared";
        field(parse_quote!(#[param(units = "mm")]), known);
    }

    #[test]
    fn parameters_of_an_entry_need_a_field_that_chooses_it() {
        let check = |attribute: syn::Attribute, expected: &str| {
            let input = parse_quote!(
                #[doc = "D"]
                struct A {
                    #[doc = "D"]
                    #[param(catalog = "c")]
                    a: String,
                    #[doc = "D"]
                    b: String,
                    #[doc = "D"]
                    #attribute
                    c: EntryParams,
                }
            );
            check(params::expand, input, expected);
        };
        check(parse_quote!(#[param(entry_of = "a")]), "");
        check(parse_quote!(#[param(entry_of = "a", odd)]), "entry_of stands alone");
        let lacks = "entry_of names a field with a catalog";
        check(parse_quote!(#[param(entry_of = "b")]), lacks);
        check(parse_quote!(#[param(entry_of = "z")]), lacks);
    }

    #[test]
    fn choices_are_documented_words() {
        let derive = choice::expand;
        check(
            derive,
            parse_quote!(
                enum A {
                    #[doc = "D"]
                    B,
                    #[doc = "D"]
                    C,
                }
            ),
            "",
        );
        check(
            derive,
            parse_quote!(
                enum A {
                    B,
                }
            ),
            NO_DOCS,
        );
        check(
            derive,
            parse_quote!(
                enum A {
                    #[doc = "D"]
                    B(u8),
                }
            ),
            "a choice has no fields",
        );
        check(
            derive,
            parse_quote!(
                struct A;
            ),
            "a choice is an enum",
        );
    }

    #[test]
    fn inputs_are_borrowed_and_outputs_owned() {
        let derive = ports::expand_inputs;
        check(
            derive,
            parse_quote!(
                struct A<'a> {
                    #[doc = "D"]
                    a: &'a T,
                }
            ),
            "",
        );
        check(
            derive,
            parse_quote!(
                struct A<'a> {
                    #[doc = "D"]
                    a: Option<&'a T>,
                }
            ),
            "",
        );
        check(
            derive,
            parse_quote!(
                struct A<'a> {
                    a: &'a T,
                }
            ),
            NO_DOCS,
        );
        let form = "an input is &'a T or Option<&'a T>";
        check(
            derive,
            parse_quote!(
                struct A<'a> {
                    #[doc = "D"]
                    a: T,
                }
            ),
            form,
        );
        check(
            derive,
            parse_quote!(
                struct A<'a> {
                    #[doc = "D"]
                    a: Option<T>,
                }
            ),
            form,
        );
        check(
            derive,
            parse_quote!(
                struct A {}
            ),
            "inputs are borrowed: add a lifetime",
        );
        check(
            ports::expand_outputs,
            parse_quote!(
                struct A {
                    #[doc = "D"]
                    a: T,
                }
            ),
            "",
        );
        check(
            ports::expand_outputs,
            parse_quote!(
                struct A {
                    a: T,
                }
            ),
            NO_DOCS,
        );
    }

    #[test]
    fn docs_are_one_paragraph() {
        let input: DeriveInput = parse_quote!(
            /// One
            ///   two.
            ///
            /// Three.
            struct A;
        );
        assert_eq!(docs(&input.attrs), "One two.  Three.");
    }
}
