// A link that holds the muscle: text in base64 after a digest, by which a link that was cut is told.

const MARK = "m1.";
const CUT = "This link is cut or damaged. Ask for it again, whole; the page shows the usual muscle instead.";

// FNV-1a over bytes: enough to tell a link that lost some of its letters.
function digest(bytes) {
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193) >>> 0;
  return hash.toString(36);
}

export function encode(asked) {
  const bytes = new TextEncoder().encode(JSON.stringify(asked));
  const text = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  return `${MARK}${digest(bytes)}.${text.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

// What a link holds; null where there is none. An error for one that was cut.
export function decode(fragment) {
  const text = decodeURIComponent(fragment.replace(/^#/, ""));
  if (!text) return null;
  const [, hash, body] = /^m1\.([0-9a-z]+)\.([\w-]+)$/.exec(text) ?? [];
  if (!hash) throw new Error(CUT);
  try {
    const raw = atob(body.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(raw, (letter) => letter.charCodeAt(0));
    if (digest(bytes) !== hash) throw new Error(CUT);
    return JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    throw new Error(CUT);
  }
}
