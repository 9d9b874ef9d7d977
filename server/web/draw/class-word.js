// The class of a point as a word on its colour.

import { classWords } from "../data/judgement.js";
import { h } from "../ui/dom.js";
import { classColour, inkOnClass } from "./picture/colours.js";

/** @param {string} name of the class @param {string} [title] */
export function classWord(name, title) {
  const style = `background:${classColour(name)};color:${inkOnClass(name)}`;
  return h("span", { class: "class-word", style, title }, classWords(name));
}
