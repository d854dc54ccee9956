//! `#[derive(Params)]`.

use crate::{Tokens, named_fields, required_docs};
use quote::quote;
use syn::ext::IdentExt;
use syn::{DeriveInput, Expr, ExprLit, ExprRange, Field, Lit, LitStr, RangeLimits};

/// What `#[param(…)]` says.
#[derive(Default)]
struct Attributes {
    default: Option<Expr>,
    unit: Option<LitStr>,
    range: Option<ExprRange>,
    odd: bool,
    catalog: Option<LitStr>,
}

pub(crate) fn expand(input: &DeriveInput) -> syn::Result<Tokens> {
    let name = &input.ident;
    let about = required_docs(&input.attrs, name)?;
    let fields = named_fields(input)?;
    let specs = fields.iter().map(|field| spec(field)).collect::<syn::Result<Vec<_>>>()?;
    let reads = fields.iter().map(|field| {
        let (ident, key) = (&field.ident, key(field));
        quote!(#ident: ::carvegraph_core::ParamField::from_value(values.get(#key)))
    });
    Ok(quote! {
        impl ::carvegraph_core::Params for #name {
            fn about() -> &'static str { #about }
            fn specs() -> ::std::vec::Vec<::carvegraph_core::ParamSpec> {
                ::std::vec![#(#specs),*]
            }
            fn from_values(values: &::carvegraph_core::ParamValues) -> Self {
                let _ = values;
                Self { #(#reads),* }
            }
        }
    })
}

fn key(field: &Field) -> String {
    field.ident.as_ref().map(|name| name.unraw().to_string()).unwrap_or_default()
}

fn spec(field: &Field) -> syn::Result<Tokens> {
    let about = required_docs(&field.attrs, field)?;
    let (key, ty) = (key(field), &field.ty);
    let attributes = read_attributes(field)?;
    let default = match &attributes.default {
        None => quote!(::std::option::Option::None),
        Some(value) => {
            let value = typed_default(value);
            quote!({
                let default: #ty = #value;
                ::std::option::Option::Some(::carvegraph_core::ParamField::to_value(&default))
            })
        }
    };
    let unit = optional(attributes.unit.as_ref().map(|unit| quote!(#unit)));
    let catalog = optional(attributes.catalog.as_ref().map(|catalog| quote!(#catalog)));
    let (min, max) = limits(attributes.range.as_ref())?;
    let odd = attributes.odd;
    Ok(quote! {
        ::carvegraph_core::ParamSpec {
            name: #key,
            about: #about,
            kind: <#ty as ::carvegraph_core::ParamField>::kind(&::carvegraph_core::ParamHints {
                unit: #unit,
                min: #min,
                max: #max,
                odd: #odd,
                catalog: #catalog,
            }),
            default: #default,
        }
    })
}

fn read_attributes(field: &Field) -> syn::Result<Attributes> {
    let mut attributes = Attributes::default();
    for attribute in field.attrs.iter().filter(|a| a.path().is_ident("param")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("default") {
                attributes.default = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("unit") {
                attributes.unit = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("range") {
                attributes.range = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("catalog") {
                attributes.catalog = Some(meta.value()?.parse()?);
            } else if meta.path.is_ident("odd") {
                attributes.odd = true;
            } else {
                return Err(meta.error("unknown: default, unit, range, odd or catalog"));
            }
            Ok(())
        })?;
    }
    Ok(attributes)
}

/// A text literal becomes whatever the field's type makes of it; anything else is taken as it is.
fn typed_default(value: &Expr) -> Tokens {
    match value {
        Expr::Lit(ExprLit { lit: Lit::Str(_), .. }) => quote!(::std::convert::From::from(#value)),
        _ => quote!(#value),
    }
}

fn optional(value: Option<Tokens>) -> Tokens {
    match value {
        Some(value) => quote!(::std::option::Option::Some(#value)),
        None => quote!(::std::option::Option::None),
    }
}

/// Both ends of the range as `f64`; an open end is infinite.
fn limits(range: Option<&ExprRange>) -> syn::Result<(Tokens, Tokens)> {
    let Some(range) = range else {
        return Ok((quote!(f64::NEG_INFINITY), quote!(f64::INFINITY)));
    };
    if range.end.is_some() && matches!(range.limits, RangeLimits::HalfOpen(_)) {
        return Err(syn::Error::new_spanned(range, "write ..=, the last value is allowed"));
    }
    let end = |value: &Option<Box<Expr>>, open: Tokens| match value {
        Some(value) => quote!((#value) as f64),
        None => open,
    };
    Ok((end(&range.start, quote!(f64::NEG_INFINITY)), end(&range.end, quote!(f64::INFINITY))))
}
