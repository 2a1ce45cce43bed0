BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0001');
CREATE TABLE attempts (
	id INTEGER NOT NULL, 
	case_id VARCHAR, 
	user_id VARCHAR, 
	"trigger" VARCHAR NOT NULL, 
	accepted BOOLEAN NOT NULL, 
	code VARCHAR NOT NULL, 
	message VARCHAR NOT NULL, 
	state VARCHAR, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_attempts PRIMARY KEY (id), 
	CONSTRAINT fk_attempts_case_id FOREIGN KEY(case_id) REFERENCES cases (id)
);
INSERT INTO "attempts" VALUES(1,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.475743Z');
INSERT INTO "attempts" VALUES(2,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.489522Z');
INSERT INTO "attempts" VALUES(3,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.499262Z');
INSERT INTO "attempts" VALUES(4,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.507505Z');
INSERT INTO "attempts" VALUES(5,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.518004Z');
INSERT INTO "attempts" VALUES(6,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.528151Z');
INSERT INTO "attempts" VALUES(7,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.535365Z');
INSERT INTO "attempts" VALUES(8,'case-1','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.539948Z');
INSERT INTO "attempts" VALUES(9,'case-1','dd188f6265124573bff09af2fa13c862','case_closed',1,'taken','','case_open','2026-11-22T09:22:47.544587Z');
INSERT INTO "attempts" VALUES(10,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.555415Z');
INSERT INTO "attempts" VALUES(11,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.560558Z');
INSERT INTO "attempts" VALUES(12,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.565202Z');
INSERT INTO "attempts" VALUES(13,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.573145Z');
INSERT INTO "attempts" VALUES(14,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.582828Z');
INSERT INTO "attempts" VALUES(15,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.593455Z');
INSERT INTO "attempts" VALUES(16,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.605348Z');
INSERT INTO "attempts" VALUES(17,'case-2','dd188f6265124573bff09af2fa13c862','plan_requested',1,'taken','','case_open','2026-11-22T09:22:47.615967Z');
INSERT INTO "attempts" VALUES(18,'case-2','dd188f6265124573bff09af2fa13c862','case_closed',1,'taken','','case_open','2026-11-22T09:22:47.625258Z');
CREATE TABLE audit_events (
	id INTEGER NOT NULL, 
	kind VARCHAR NOT NULL, 
	user_id VARCHAR, 
	data JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_audit_events PRIMARY KEY (id)
);
INSERT INTO "audit_events" VALUES(1,'user_added',NULL,'{"name":"anna","role":"surgeon","user_id":"dd188f6265124573bff09af2fa13c862"}','2026-11-22T09:22:47.414478Z');
INSERT INTO "audit_events" VALUES(2,'signed_in','dd188f6265124573bff09af2fa13c862','{"session":"s-1"}','2026-11-22T09:22:47.441658Z');
INSERT INTO "audit_events" VALUES(3,'signed_out','dd188f6265124573bff09af2fa13c862','{"session":"s-1"}','2026-11-22T09:22:47.632212Z');
CREATE TABLE cases (
	id VARCHAR NOT NULL, 
	room VARCHAR(64) NOT NULL, 
	patient_id VARCHAR NOT NULL, 
	study_uid VARCHAR NOT NULL, 
	opened_by VARCHAR NOT NULL, 
	product_version VARCHAR NOT NULL, 
	settings_sha256 VARCHAR(64) NOT NULL, 
	devices JSON NOT NULL, 
	opened_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_cases PRIMARY KEY (id), 
	CONSTRAINT fk_cases_opened_by FOREIGN KEY(opened_by) REFERENCES users (id)
);
INSERT INTO "cases" VALUES('case-1','room-0','P1','1.2','dd188f6265124573bff09af2fa13c862','0.1.0','0000000000000000000000000000000000000000000000000000000000000000','{}','2026-11-22T09:22:47.424351Z');
INSERT INTO "cases" VALUES('case-2','room-1','P1','1.2','dd188f6265124573bff09af2fa13c862','0.1.0','0000000000000000000000000000000000000000000000000000000000000000','{}','2026-11-22T09:22:47.437024Z');
CREATE TABLE device_files (
	id VARCHAR NOT NULL, 
	kind VARCHAR(8) NOT NULL, 
	name VARCHAR NOT NULL, 
	version VARCHAR NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	expires VARCHAR(10), 
	content BLOB NOT NULL, 
	uploaded_by VARCHAR NOT NULL, 
	position INTEGER NOT NULL, 
	uploaded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_device_files PRIMARY KEY (id), 
	CONSTRAINT fk_device_files_uploaded_by FOREIGN KEY(uploaded_by) REFERENCES users (id), 
	CONSTRAINT uq_device_files_kind_name_version UNIQUE (kind, name, version), 
	CONSTRAINT uq_device_files_position UNIQUE (position)
);
INSERT INTO "device_files" VALUES('device-1','tcp','tool','1','ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff',NULL,X'6E616D65203D2031','dd188f6265124573bff09af2fa13c862',1,'2026-01-01T00:00:00.000000Z');
CREATE TABLE evaluations (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	image_id VARCHAR NOT NULL, 
	CONSTRAINT pk_evaluations PRIMARY KEY (id), 
	CONSTRAINT fk_evaluations_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_evaluations_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "evaluations" VALUES('case-1-evaluations','case-1',8,'[]','{"value":0.1234567}','2026-11-22T09:22:47.536261Z','f883f95823a844f992c68ab6396ce859');
INSERT INTO "evaluations" VALUES('case-2-evaluations','case-2',8,'[]','{"value":0.1234567}','2026-11-22T09:22:47.607643Z','f883f95823a844f992c68ab6396ce859');
CREATE TABLE events (
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	version INTEGER NOT NULL, 
	"trigger" VARCHAR NOT NULL, 
	user_id VARCHAR, 
	state VARCHAR NOT NULL, 
	case_state JSON NOT NULL, 
	data JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_events PRIMARY KEY (case_id, sequence), 
	CONSTRAINT fk_events_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_events_user_id FOREIGN KEY(user_id) REFERENCES users (id)
);
INSERT INTO "events" VALUES('case-1',1,1,'case_opened','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.428123Z');
INSERT INTO "events" VALUES('case-2',1,1,'case_opened','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.437848Z');
INSERT INTO "events" VALUES('case-1',2,2,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.482381Z');
INSERT INTO "events" VALUES('case-1',3,3,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.490837Z');
INSERT INTO "events" VALUES('case-1',4,4,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.502008Z');
INSERT INTO "events" VALUES('case-1',5,5,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.511677Z');
INSERT INTO "events" VALUES('case-1',6,6,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.520700Z');
INSERT INTO "events" VALUES('case-1',7,7,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.531550Z');
INSERT INTO "events" VALUES('case-1',8,8,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.536261Z');
INSERT INTO "events" VALUES('case-1',9,9,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.541321Z');
INSERT INTO "events" VALUES('case-1',10,10,'case_closed','dd188f6265124573bff09af2fa13c862','closed','{}','{}','2026-11-22T09:22:47.545455Z');
INSERT INTO "events" VALUES('case-2',2,2,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.557913Z');
INSERT INTO "events" VALUES('case-2',3,3,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.561483Z');
INSERT INTO "events" VALUES('case-2',4,4,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.566028Z');
INSERT INTO "events" VALUES('case-2',5,5,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.577083Z');
INSERT INTO "events" VALUES('case-2',6,6,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.586936Z');
INSERT INTO "events" VALUES('case-2',7,7,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.598125Z');
INSERT INTO "events" VALUES('case-2',8,8,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.607643Z');
INSERT INTO "events" VALUES('case-2',9,9,'x','dd188f6265124573bff09af2fa13c862','case_open','{"note":"\u00b5","state":"case_open"}','{"row":1}','2026-11-22T09:22:47.616869Z');
INSERT INTO "events" VALUES('case-2',10,10,'note','dd188f6265124573bff09af2fa13c862','case_open','{}','{}','2026-11-22T09:22:47.626175Z');
CREATE TABLE idempotency_keys (
	user_id VARCHAR NOT NULL, 
	"key" VARCHAR(128) NOT NULL, 
	request_sha256 VARCHAR(64) NOT NULL, 
	status INTEGER NOT NULL, 
	body JSON NOT NULL, 
	version INTEGER, 
	created_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_idempotency_keys PRIMARY KEY (user_id, "key")
);
CREATE TABLE image_bytes (
	sha256 VARCHAR(64) NOT NULL, 
	content BLOB NOT NULL, 
	CONSTRAINT pk_image_bytes PRIMARY KEY (sha256)
);
INSERT INTO "image_bytes" VALUES('cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6',X'696D6167652030');
INSERT INTO "image_bytes" VALUES('bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b',X'696D6167652031');
INSERT INTO "image_bytes" VALUES('32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9',X'696D6167652032');
CREATE TABLE image_purposes (
	image_id VARCHAR NOT NULL, 
	case_id VARCHAR, 
	purpose VARCHAR NOT NULL, 
	arm JSON NOT NULL, 
	verdicts JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_image_purposes PRIMARY KEY (image_id), 
	CONSTRAINT fk_image_purposes_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_image_purposes_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "image_purposes" VALUES('dedc2bab1aa64e27a630fdf963879462','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:47.455020Z');
INSERT INTO "image_purposes" VALUES('f883f95823a844f992c68ab6396ce859','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:47.462663Z');
INSERT INTO "image_purposes" VALUES('353839946fb84d6f9b67c3e3626e7375','case-1','registration','{"joints_rad":[0.1]}','[]','2026-11-22T09:22:47.472258Z');
CREATE TABLE images (
	id VARCHAR NOT NULL, 
	position INTEGER NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	sop_uid VARCHAR, 
	pixel_sha256 VARCHAR(64), 
	duplicate_of VARCHAR, 
	patient_id VARCHAR, 
	study_uid VARCHAR, 
	problem JSON, 
	source JSON NOT NULL, 
	metadata JSON NOT NULL, 
	received_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_images PRIMARY KEY (id), 
	CONSTRAINT fk_images_duplicate_of FOREIGN KEY(duplicate_of) REFERENCES images (id), 
	CONSTRAINT fk_images_sha256 FOREIGN KEY(sha256) REFERENCES image_bytes (sha256), 
	CONSTRAINT uq_images_position UNIQUE (position)
);
INSERT INTO "images" VALUES('dedc2bab1aa64e27a630fdf963879462',1,'cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6','1.0','1.2',NULL,'0000000000000000000000000000000000000000000000000000000000000000','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:47.452017Z');
INSERT INTO "images" VALUES('f883f95823a844f992c68ab6396ce859',2,'bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b','1.1','1.2','dedc2bab1aa64e27a630fdf963879462','1111111111111111111111111111111111111111111111111111111111111111','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:47.458806Z');
INSERT INTO "images" VALUES('353839946fb84d6f9b67c3e3626e7375',3,'32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9','1.2','1.2','dedc2bab1aa64e27a630fdf963879462','2222222222222222222222222222222222222222222222222222222222222222','P1',NULL,'{"calling_ae":"CARM"}','{"rows":96}','2026-11-22T09:22:47.467354Z');
CREATE TABLE insertions (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_insertions PRIMARY KEY (id), 
	CONSTRAINT fk_insertions_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "insertions" VALUES('case-1-insertions','case-1',9,'[]','{"value":0.1234567}','2026-11-22T09:22:47.541321Z');
INSERT INTO "insertions" VALUES('case-2-insertions','case-2',9,'[]','{"value":0.1234567}','2026-11-22T09:22:47.616869Z');
CREATE TABLE leases (
	case_id VARCHAR NOT NULL, 
	fencing_token INTEGER NOT NULL, 
	session_id VARCHAR NOT NULL, 
	user_id VARCHAR NOT NULL, 
	reason VARCHAR NOT NULL, 
	taken_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_leases PRIMARY KEY (case_id), 
	CONSTRAINT fk_leases_case_id FOREIGN KEY(case_id) REFERENCES cases (id), 
	CONSTRAINT fk_leases_session_id FOREIGN KEY(session_id) REFERENCES sessions (id), 
	CONSTRAINT fk_leases_user_id FOREIGN KEY(user_id) REFERENCES users (id)
);
CREATE TABLE lock_outs (
	subject VARCHAR NOT NULL, 
	until_s FLOAT NOT NULL, 
	CONSTRAINT pk_lock_outs PRIMARY KEY (subject)
);
CREATE TABLE motions (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	trajectory BLOB, 
	CONSTRAINT pk_motions PRIMARY KEY (id), 
	CONSTRAINT fk_motions_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "motions" VALUES('case-1-motions','case-1',7,'[]','{"value":0.1234567}','2026-11-22T09:22:47.531550Z',X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F202122232425262728292A2B2C2D2E2F303132333435363738393A3B3C3D3E3F');
INSERT INTO "motions" VALUES('case-2-motions','case-2',7,'[]','{"value":0.1234567}','2026-11-22T09:22:47.598125Z',X'000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F202122232425262728292A2B2C2D2E2F303132333435363738393A3B3C3D3E3F');
CREATE TABLE permit_uses (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_permit_uses PRIMARY KEY (id), 
	CONSTRAINT fk_permit_uses_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_permit_uses_id FOREIGN KEY(id) REFERENCES permits (id)
);
INSERT INTO "permit_uses" VALUES('case-1-permits','case-1',6,'[]','{"value":0.1234567}','2026-11-22T09:22:47.520700Z');
INSERT INTO "permit_uses" VALUES('case-2-permits','case-2',6,'[]','{"value":0.1234567}','2026-11-22T09:22:47.586936Z');
CREATE TABLE permits (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	approved_by VARCHAR NOT NULL, 
	CONSTRAINT pk_permits PRIMARY KEY (id), 
	CONSTRAINT fk_permits_approved_by FOREIGN KEY(approved_by) REFERENCES users (id), 
	CONSTRAINT fk_permits_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "permits" VALUES('case-1-permits','case-1',5,'[]','{"value":0.1234567}','2026-11-22T09:22:47.511677Z','dd188f6265124573bff09af2fa13c862');
INSERT INTO "permits" VALUES('case-2-permits','case-2',5,'[]','{"value":0.1234567}','2026-11-22T09:22:47.577083Z','dd188f6265124573bff09af2fa13c862');
CREATE TABLE planned_targets (
	case_id VARCHAR NOT NULL, 
	name VARCHAR NOT NULL, 
	content JSON NOT NULL, 
	CONSTRAINT pk_planned_targets PRIMARY KEY (case_id, name), 
	CONSTRAINT fk_planned_targets_case_id FOREIGN KEY(case_id) REFERENCES cases (id)
);
INSERT INTO "planned_targets" VALUES('case-1','L3','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-1','L4','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-2','L3','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO "planned_targets" VALUES('case-2','L4','{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
CREATE TABLE plans (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_plans PRIMARY KEY (id), 
	CONSTRAINT fk_plans_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "plans" VALUES('case-1-plans','case-1',4,'[]','{"value":0.1234567}','2026-11-22T09:22:47.502008Z');
INSERT INTO "plans" VALUES('case-2-plans','case-2',4,'[]','{"value":0.1234567}','2026-11-22T09:22:47.566028Z');
CREATE TABLE registrations (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	image_id VARCHAR NOT NULL, 
	CONSTRAINT pk_registrations PRIMARY KEY (id), 
	CONSTRAINT fk_registrations_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence), 
	CONSTRAINT fk_registrations_image_id FOREIGN KEY(image_id) REFERENCES images (id)
);
INSERT INTO "registrations" VALUES('case-1-registrations','case-1',2,'[]','{"value":0.1234567}','2026-11-22T09:22:47.482381Z','dedc2bab1aa64e27a630fdf963879462');
INSERT INTO "registrations" VALUES('case-2-registrations','case-2',2,'[]','{"value":0.1234567}','2026-11-22T09:22:47.557913Z','dedc2bab1aa64e27a630fdf963879462');
CREATE TABLE room_claims (
	room VARCHAR(64) NOT NULL, 
	holder VARCHAR NOT NULL, 
	claimed_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_room_claims PRIMARY KEY (room)
);
CREATE TABLE sessions (
	id VARCHAR NOT NULL, 
	token_sha256 VARCHAR(64) NOT NULL, 
	user_id VARCHAR NOT NULL, 
	created_at VARCHAR(32) NOT NULL, 
	expires_at_s FLOAT NOT NULL, 
	last_seen_at_s FLOAT NOT NULL, 
	locked_at VARCHAR(32), 
	revoked_at VARCHAR(32), 
	CONSTRAINT pk_sessions PRIMARY KEY (id), 
	CONSTRAINT fk_sessions_user_id FOREIGN KEY(user_id) REFERENCES users (id), 
	CONSTRAINT uq_sessions_token_sha256 UNIQUE (token_sha256)
);
CREATE TABLE targets (
	id VARCHAR NOT NULL, 
	case_id VARCHAR NOT NULL, 
	sequence INTEGER NOT NULL, 
	made_from JSON NOT NULL, 
	content JSON NOT NULL, 
	recorded_at VARCHAR(32) NOT NULL, 
	CONSTRAINT pk_targets PRIMARY KEY (id), 
	CONSTRAINT fk_targets_case_id_sequence FOREIGN KEY(case_id, sequence) REFERENCES events (case_id, sequence)
);
INSERT INTO "targets" VALUES('case-1-targets','case-1',3,'[]','{"value":0.1234567}','2026-11-22T09:22:47.490837Z');
INSERT INTO "targets" VALUES('case-2-targets','case-2',3,'[]','{"value":0.1234567}','2026-11-22T09:22:47.561483Z');
CREATE TABLE users (
	id VARCHAR NOT NULL, 
	name VARCHAR(64) NOT NULL, 
	role VARCHAR(16) NOT NULL, 
	password_hash VARCHAR NOT NULL, 
	pin_hash VARCHAR NOT NULL, 
	created_at VARCHAR(32) NOT NULL, 
	disabled_at VARCHAR(32), 
	CONSTRAINT pk_users PRIMARY KEY (id), 
	CONSTRAINT uq_users_name UNIQUE (name)
);
INSERT INTO "users" VALUES('dd188f6265124573bff09af2fa13c862','anna','surgeon','$argon2id$v=19$m=8,t=1,p=1$t/72qBXi0FzNunm6ZoUKIw$BEYh/WhIuF0yCWrI3uQJ36n6q2ToSHW0ZJ81l3ch9Bo','$argon2id$v=19$m=8,t=1,p=1$ZW4Nm84aRKnNCD5X7B6HWQ$R84m2O8NihStPvGK+4hQm7rIKYYWnWYquPjybg0UUlk','2026-11-22T09:22:47.412735Z',NULL);
CREATE TABLE verdicts (
	id INTEGER NOT NULL, 
	attempt_id INTEGER NOT NULL, 
	code VARCHAR NOT NULL, 
	hazard VARCHAR NOT NULL, 
	passed BOOLEAN NOT NULL, 
	measured JSON, 
	"limit" JSON, 
	unit VARCHAR NOT NULL, 
	message VARCHAR NOT NULL, 
	CONSTRAINT pk_verdicts PRIMARY KEY (id), 
	CONSTRAINT fk_verdicts_attempt_id FOREIGN KEY(attempt_id) REFERENCES attempts (id)
);
INSERT INTO "verdicts" VALUES(1,1,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(2,1,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(3,2,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(4,2,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(5,3,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(6,3,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(7,4,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(8,4,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(9,5,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(10,5,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(11,6,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(12,6,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(13,7,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(14,7,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(15,8,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(16,8,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(17,9,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(18,9,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(19,10,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(20,10,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(21,11,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(22,11,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(23,12,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(24,12,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(25,13,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(26,13,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(27,14,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(28,14,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(29,15,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(30,15,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(31,16,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(32,16,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(33,17,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(34,17,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
INSERT INTO "verdicts" VALUES(35,18,'image_age','H03',1,12.3456789,1800,'s','');
INSERT INTO "verdicts" VALUES(36,18,'guide_empty','H35',0,'"wire"','"empty"','','the guide is not stated to be empty');
CREATE INDEX ix_images_pixel_sha256 ON images (pixel_sha256);
CREATE INDEX ix_images_sha256 ON images (sha256);
CREATE INDEX ix_images_sop_uid ON images (sop_uid);
CREATE INDEX ix_attempts_case_id ON attempts (case_id);
CREATE INDEX ix_image_purposes_case_id ON image_purposes (case_id);
CREATE INDEX ix_verdicts_attempt_id ON verdicts (attempt_id);
CREATE TRIGGER cases_refuse_update BEFORE UPDATE ON cases BEGIN SELECT RAISE(ABORT, 'cases is append-only'); END;
CREATE TRIGGER cases_refuse_delete BEFORE DELETE ON cases BEGIN SELECT RAISE(ABORT, 'cases is append-only'); END;
CREATE TRIGGER planned_targets_refuse_update BEFORE UPDATE ON planned_targets BEGIN SELECT RAISE(ABORT, 'planned_targets is append-only'); END;
CREATE TRIGGER planned_targets_refuse_delete BEFORE DELETE ON planned_targets BEGIN SELECT RAISE(ABORT, 'planned_targets is append-only'); END;
CREATE TRIGGER events_refuse_update BEFORE UPDATE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER events_refuse_delete BEFORE DELETE ON events BEGIN SELECT RAISE(ABORT, 'events is append-only'); END;
CREATE TRIGGER audit_events_refuse_update BEFORE UPDATE ON audit_events BEGIN SELECT RAISE(ABORT, 'audit_events is append-only'); END;
CREATE TRIGGER audit_events_refuse_delete BEFORE DELETE ON audit_events BEGIN SELECT RAISE(ABORT, 'audit_events is append-only'); END;
CREATE TRIGGER attempts_refuse_update BEFORE UPDATE ON attempts BEGIN SELECT RAISE(ABORT, 'attempts is append-only'); END;
CREATE TRIGGER attempts_refuse_delete BEFORE DELETE ON attempts BEGIN SELECT RAISE(ABORT, 'attempts is append-only'); END;
CREATE TRIGGER verdicts_refuse_update BEFORE UPDATE ON verdicts BEGIN SELECT RAISE(ABORT, 'verdicts is append-only'); END;
CREATE TRIGGER verdicts_refuse_delete BEFORE DELETE ON verdicts BEGIN SELECT RAISE(ABORT, 'verdicts is append-only'); END;
CREATE TRIGGER device_files_refuse_update BEFORE UPDATE ON device_files BEGIN SELECT RAISE(ABORT, 'device_files is append-only'); END;
CREATE TRIGGER device_files_refuse_delete BEFORE DELETE ON device_files BEGIN SELECT RAISE(ABORT, 'device_files is append-only'); END;
CREATE TRIGGER image_bytes_refuse_update BEFORE UPDATE ON image_bytes BEGIN SELECT RAISE(ABORT, 'image_bytes is append-only'); END;
CREATE TRIGGER image_bytes_refuse_delete BEFORE DELETE ON image_bytes BEGIN SELECT RAISE(ABORT, 'image_bytes is append-only'); END;
CREATE TRIGGER images_refuse_update BEFORE UPDATE ON images BEGIN SELECT RAISE(ABORT, 'images is append-only'); END;
CREATE TRIGGER images_refuse_delete BEFORE DELETE ON images BEGIN SELECT RAISE(ABORT, 'images is append-only'); END;
CREATE TRIGGER image_purposes_refuse_update BEFORE UPDATE ON image_purposes BEGIN SELECT RAISE(ABORT, 'image_purposes is append-only'); END;
CREATE TRIGGER image_purposes_refuse_delete BEFORE DELETE ON image_purposes BEGIN SELECT RAISE(ABORT, 'image_purposes is append-only'); END;
CREATE TRIGGER registrations_refuse_update BEFORE UPDATE ON registrations BEGIN SELECT RAISE(ABORT, 'registrations is append-only'); END;
CREATE TRIGGER registrations_refuse_delete BEFORE DELETE ON registrations BEGIN SELECT RAISE(ABORT, 'registrations is append-only'); END;
CREATE TRIGGER targets_refuse_update BEFORE UPDATE ON targets BEGIN SELECT RAISE(ABORT, 'targets is append-only'); END;
CREATE TRIGGER targets_refuse_delete BEFORE DELETE ON targets BEGIN SELECT RAISE(ABORT, 'targets is append-only'); END;
CREATE TRIGGER plans_refuse_update BEFORE UPDATE ON plans BEGIN SELECT RAISE(ABORT, 'plans is append-only'); END;
CREATE TRIGGER plans_refuse_delete BEFORE DELETE ON plans BEGIN SELECT RAISE(ABORT, 'plans is append-only'); END;
CREATE TRIGGER permits_refuse_update BEFORE UPDATE ON permits BEGIN SELECT RAISE(ABORT, 'permits is append-only'); END;
CREATE TRIGGER permits_refuse_delete BEFORE DELETE ON permits BEGIN SELECT RAISE(ABORT, 'permits is append-only'); END;
CREATE TRIGGER permit_uses_refuse_update BEFORE UPDATE ON permit_uses BEGIN SELECT RAISE(ABORT, 'permit_uses is append-only'); END;
CREATE TRIGGER permit_uses_refuse_delete BEFORE DELETE ON permit_uses BEGIN SELECT RAISE(ABORT, 'permit_uses is append-only'); END;
CREATE TRIGGER motions_refuse_update BEFORE UPDATE ON motions BEGIN SELECT RAISE(ABORT, 'motions is append-only'); END;
CREATE TRIGGER motions_refuse_delete BEFORE DELETE ON motions BEGIN SELECT RAISE(ABORT, 'motions is append-only'); END;
CREATE TRIGGER evaluations_refuse_update BEFORE UPDATE ON evaluations BEGIN SELECT RAISE(ABORT, 'evaluations is append-only'); END;
CREATE TRIGGER evaluations_refuse_delete BEFORE DELETE ON evaluations BEGIN SELECT RAISE(ABORT, 'evaluations is append-only'); END;
CREATE TRIGGER insertions_refuse_update BEFORE UPDATE ON insertions BEGIN SELECT RAISE(ABORT, 'insertions is append-only'); END;
CREATE TRIGGER insertions_refuse_delete BEFORE DELETE ON insertions BEGIN SELECT RAISE(ABORT, 'insertions is append-only'); END;
COMMIT;
