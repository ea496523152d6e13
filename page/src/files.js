// Files in and out: case files that are opened, and what is downloaded.

import { at, el } from "./dom.js";
import { menu } from "./menu.js";
import { notice } from "./notices.js";

const MOST = 2e6;
const KINDS = {
  toml: "Case file (TOML)", csv: "Curve as a table (CSV)", txt: "Notes on the table (TXT)", nc: "Curve with all fields (NetCDF)",
  pdf: "Datasheet (PDF)", glb: "Shape (glTF)",
};

export async function answered(response) {
  if (response.ok) return response;
  const said = await response.json().catch(() => ({}));
  throw new Error(said.error ?? `the server said ${response.status}`);
}

// The muscle of a case file; `opened(told)` takes it.
export async function openCase(file, opened) {
  try {
    if (file.size > MOST) throw new Error(`the file is too large: a case file has at most ${MOST / 1e6} MB`);
    const response = await fetch(`case?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
    opened(await (await answered(response)).json());
  } catch (error) {
    notice(`${file.name} was not opened: ${error.message}`, "wrong");
  }
}

async function download(kind, store) {
  const line = notice(`Making: ${KINDS[kind]} …`);
  try {
    const body = JSON.stringify(store.asked());
    const response = await answered(await fetch(`file/${kind}`, { method: "POST", body }));
    const name = /filename="?([^";]+)/.exec(response.headers.get("content-disposition") ?? "")?.[1] ?? `muscle.${kind}`;
    const link = el("a", { href: URL.createObjectURL(await response.blob()), download: name });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    line.remove();
  } catch (error) {
    line.remove();
    notice(`${KINDS[kind]} was not made: ${error.message}`, "wrong");
  }
}

export function downloads(store) {
  menu("downloads", Object.entries(KINDS).map(([kind, words]) => [words, () => download(kind, store), kind]));
}

export function uploads(opened) {
  at("open").addEventListener("click", () => at("file").click());
  at("file").addEventListener("change", () => {
    const [file] = at("file").files;
    at("file").value = "";
    if (file) openCase(file, opened);
  });
}
