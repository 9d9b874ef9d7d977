// Names of the sheets of an Excel workbook, which is an archive of XML files.

const CENTRAL_FILE = 0x02014b50,
  END = 0x06054b50;
const DEFLATED = 8;
/** The end of an archive: its record and the longest comment. */
const LONGEST_END = 22 + 0xffff;
/** Bytes of a list of sheets, and of the directory of an archive, beyond which it is not read. */
const MOST = 1 << 20;
const LIST = "xl/workbook.xml";

/**
 * Sheets of a workbook in their order; none of a file of another kind.
 * @param {Blob} file
 * @returns {Promise<string[]>}
 */
export async function sheetNames(file) {
  const list = await fileOf(file, LIST);
  if (list === null) return [];
  const sheets = new DOMParser()
    .parseFromString(list, "application/xml")
    .getElementsByTagNameNS("*", "sheet");
  return Array.from(sheets, (sheet) => sheet.getAttribute("name") ?? "").filter(Boolean);
}

/**
 * Text of a file in an archive; null if it has none of the name.
 * @param {Blob} archive
 * @param {string} wanted
 */
export async function fileOf(archive, wanted) {
  const ending = await viewOf(archive, Math.max(0, archive.size - LONGEST_END), archive.size);
  let end = ending.byteLength - 22;
  while (end >= 0 && ending.getUint32(end, true) !== END) end -= 1;
  if (end < 0) return null;
  const [size, start] = [ending.getUint32(end + 12, true), ending.getUint32(end + 16, true)];
  const directory = await viewOf(archive, start, start + Math.min(size, MOST));
  let at = 0;
  while (at + 46 <= directory.byteLength && directory.getUint32(at, true) === CENTRAL_FILE) {
    const [nameLength, extraLength, commentLength] = [28, 30, 32].map((offset) =>
      directory.getUint16(at + offset, true),
    );
    const name = text(directory, at + 46, Math.min(nameLength, directory.byteLength - at - 46));
    if (name === wanted)
      return contents(archive, {
        isDeflated: directory.getUint16(at + 10, true) === DEFLATED,
        length: directory.getUint32(at + 20, true),
        start: directory.getUint32(at + 42, true),
      });
    at += 46 + nameLength + extraLength + commentLength;
  }
  return null;
}

/** @param {Blob} archive @param {{isDeflated: boolean, length: number, start: number}} entry of its directory */
async function contents(archive, { isDeflated, length, start }) {
  const header = await viewOf(archive, start, start + 30);
  if (length > MOST || header.byteLength < 30) return null;
  const data = start + 30 + header.getUint16(26, true) + header.getUint16(28, true);
  const stored = archive.slice(data, data + length);
  if (!isDeflated) return stored.text();
  const inflated = stored.stream().pipeThrough(new DecompressionStream("deflate-raw"));
  // A damaged file is refused by the service, with the reason.
  return new Response(inflated).text().catch(() => null);
}

/** @param {Blob} file @param {number} from @param {number} to */
async function viewOf(file, from, to) {
  return new DataView(await file.slice(from, to).arrayBuffer());
}

/** @param {DataView} view @param {number} from @param {number} length */
function text(view, from, length) {
  return new TextDecoder().decode(new Uint8Array(view.buffer, from, length));
}
