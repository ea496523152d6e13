// The link that holds the muscle, in the address line and in a dialog.

import { at, el } from "./dom.js";
import { decode, encode } from "./link.js";
import { dialog } from "./notices.js";

export const keep = (store) => history.replaceState(null, "", `#${encode(store.asked())}`);
export const held = () => decode(location.hash);

export function sharing(store) {
  at("share").addEventListener("click", async () => {
    keep(store);
    const field = el("input", { type: "text", readonly: true, value: location.href, class: "link", "aria-label": "Link" });
    const copied = el("p", { class: "quiet", role: "status" });
    dialog("A link to this muscle", el("p", { text: "It holds the muscle, the pressure and the load. It opens wherever mckibben serve runs." }),
      field, copied);
    field.select();
    try {
      await navigator.clipboard.writeText(location.href);
      copied.textContent = "Copied.";
    } catch {
      copied.textContent = "Copy it from the field.";
    }
  });
}
