//! `#[derive(Choice)]`.

use crate::{Tokens, required_docs};
use quote::quote;
use syn::{DeriveInput, Variant};

pub(crate) fn expand(input: &DeriveInput) -> syn::Result<Tokens> {
    let name = &input.ident;
    let syn::Data::Enum(data) = &input.data else {
        return Err(syn::Error::new_spanned(input, "a choice is an enum"));
    };
    let mut options = Vec::new();
    let mut to_word = Vec::new();
    let mut from_word = Vec::new();
    for variant in &data.variants {
        let (ident, word) = (&variant.ident, word(variant)?);
        let about = required_docs(&variant.attrs, variant)?;
        options.push(quote!(::carvegraph_core::ChoiceOption { name: #word, about: #about }));
        to_word.push(quote!(Self::#ident => #word));
        from_word.push(quote!(#word => Self::#ident));
    }
    Ok(quote! {
        impl ::carvegraph_core::ParamField for #name {
            type Plain = Self;

            fn kind(_: &::carvegraph_core::ParamHints) -> ::carvegraph_core::ParamKind {
                const OPTIONS: &[::carvegraph_core::ChoiceOption] = &[#(#options),*];
                ::carvegraph_core::ParamKind::Choice(OPTIONS)
            }
            fn to_value(&self) -> ::carvegraph_core::ParamValue {
                let word = match self { #(#to_word),* };
                ::carvegraph_core::ParamValue::Text(::std::string::String::from(word))
            }
            fn from_value(value: &::carvegraph_core::ParamValue) -> Self {
                match value.text() {
                    #(#from_word,)*
                    other => ::std::unreachable!("{other} was checked against the options"),
                }
            }
        }
    })
}

/// `OneWay` is spelled `one_way`.
fn word(variant: &Variant) -> syn::Result<String> {
    if !variant.fields.is_empty() {
        return Err(syn::Error::new_spanned(variant, "a choice has no fields"));
    }
    let mut word = String::new();
    for letter in variant.ident.to_string().chars() {
        if letter.is_uppercase() && !word.is_empty() {
            word.push('_');
        }
        word.extend(letter.to_lowercase());
    }
    Ok(word)
}
