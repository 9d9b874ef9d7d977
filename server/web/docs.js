/**
 * The API's document as pages to read and try, by Swagger UI.
 *
 * @typedef {((settings: Record<string, unknown>) => void) & { presets: { apis: unknown }, plugins: { DownloadUrl: unknown } }} SwaggerUi
 */

const { SwaggerUIBundle } = /** @type {Window & { SwaggerUIBundle: SwaggerUi }} */ (
  /** @type {unknown} */ (window)
);

SwaggerUIBundle({
  dom_id: "#swagger-ui",
  url: "/openapi.json",
  deepLinking: true,
  presets: [SwaggerUIBundle.presets.apis],
  plugins: [SwaggerUIBundle.plugins.DownloadUrl],
});
