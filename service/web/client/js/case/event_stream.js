/** Server-sent events from a response's body; EventSource cannot begin behind a known event. */

/**
 * Batches of events, each parsed from its data.
 * @param {ReadableStream<Uint8Array>} body
 */
export async function* eventsIn(body) {
  let left = "";
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const blocks = (left + value).split("\n\n");
    left = blocks.pop() ?? "";
    const batch = blocks.map(dataOf).filter((data) => data !== "");
    if (batch.length > 0) yield batch.map((data) => JSON.parse(data));
  }
}

/** @param {string} block */
function dataOf(block) {
  const lines = block.split("\n").filter((line) => line.startsWith("data:"));
  return lines.map((line) => line.slice(5).trim()).join("\n");
}
